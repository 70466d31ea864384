// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/grid_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "bins.h"
#include "store/files/terrain_file.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

Provenance provenance() { return {.tool = "test", .config = {{"a", 1}}, .inputs = {{"terrain", "abc"}}}; }

Grid<double> waves(const GridSpec& spec) {
  Grid<double> grid(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) grid.values()[i] = std::sin(0.01 * static_cast<double>(i));
  grid.values()[7] = std::numeric_limits<double>::quiet_NaN();
  return grid;
}

void write(const std::filesystem::path& path, const GridSpec& spec, const Provenance& from) {
  LandfallFileWriter file({path, true, 1}, "dem", from);
  GridLayerWriter layers(file, spec, "");
  layers.write("z", waves(spec), {"m", "z"});
  layers.write("count", Grid<std::int32_t>(spec, 3), {"1", "count"});
  file.commit();
}

TEST(GridFile, ReadingTellsHowFarItIs) {
  const TemporaryFolder folder;
  write(folder / "a.h5", {1, 0, 0, 700, 300}, provenance());
  const LandfallFileReader file(folder / "a.h5", {"dem"});
  std::vector<double> fractions;
  static_cast<void>(
      GridLayerReader(file).read<double>("z", [&](double fraction) { fractions.push_back(fraction); }));
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.size(), 6U);
  EXPECT_EQ(fractions.front(), 0);
  EXPECT_EQ(fractions.back(), 1);
}

TEST(LargeTerrain, WindowsAreTheWholeFilesNodes) {
  const TemporaryFolder folder;
  GeneratedTerrain terrain;
  terrain.nodes = waves({0.5, -350, -150, 700, 300});
  LandfallFileWriter file({folder / "t.h5", true, 1}, "terrain", provenance());
  write_terrain(file, terrain);
  EXPECT_FALSE(open_large_terrain(folder / "t.h5").has_value());
  const auto large = open_large_terrain(folder / "t.h5", 1000);
  ASSERT_TRUE(large.has_value());
  EXPECT_EQ(large->terrain.spec, terrain.nodes.spec());
  EXPECT_NEAR(large->terrain.lowest_m, -1, 1e-4);
  EXPECT_NEAR(large->terrain.highest_m, 1, 1e-4);
  const GridSpec spec{0.5, -350 + 256, -150, 444, 256};
  const Grid<double> window = large->terrain.load(spec);
  for (const auto [row, col] : bins_of(spec))
    ASSERT_EQ(window.at({row, col}), terrain.nodes.at({row + 256, col}));
}

// Larger than one tile in one direction, smaller in the other; not square, not centred.
TEST(GridFile, RoundTrip) {
  const TemporaryFolder folder;
  const GridSpec spec{0.05, -10, 5, 300, 20};
  write(folder / "a.h5", spec, provenance());
  const LandfallFileReader file(folder / "a.h5", {"terrain", "dem"});
  const GridLayerReader layers(file);
  EXPECT_EQ(layers.spec(), spec);
  EXPECT_TRUE(layers.has("count"));
  EXPECT_FALSE(layers.has("y_true"));
  const Grid<double> read = layers.read<double>("z");
  const Grid<double> expected = waves(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    if (std::isnan(expected.values()[i])) {
      EXPECT_TRUE(std::isnan(read.values()[i]));
    } else {
      EXPECT_EQ(read.values()[i], expected.values()[i]);
    }
  }
  EXPECT_EQ(layers.read<std::int32_t>("count").values()[5], 3);
}

/// The attribute actual_range of a layer and its type.
std::optional<std::array<double, 2>> stored_range(const LandfallFileReader& file, const std::string& layer,
                                                  h5::Type type) {
  const h5::Handle dataset = h5::open_dataset(file.root(), layer);
  if (H5Aexists(dataset.get(), "actual_range") <= 0) return std::nullopt;
  const h5::Handle attribute(H5Aopen(dataset.get(), "actual_range", H5P_DEFAULT), H5Aclose);
  const h5::Handle stored(H5Aget_type(attribute.get()), H5Tclose);
  EXPECT_GT(H5Tequal(stored.get(), h5::native(type)), 0) << layer;
  return h5::read_pair_attribute(dataset.get(), "actual_range");
}

// 300 x 20: two tiles, both padded to 256 columns with NaN or 0.
TEST(GridFile, EveryLayerHasItsRangeInItsOwnType) {
  const TemporaryFolder folder;
  const GridSpec spec{0.05, -10, 5, 300, 20};
  constexpr float kFloatNan = std::numeric_limits<float>::quiet_NaN();
  {
    LandfallFileWriter file({folder / "a.h5", true, 1}, "dem", provenance());
    GridLayerWriter layers(file, spec, "");
    layers.write("z", waves(spec), {"m", "z"});
    Grid<std::int8_t> flags(spec, 5);
    flags.at({299, 19}) = -7;
    layers.write("flags", flags, {"1", "flags"});
    layers.write("none", Grid<float>(spec, kFloatNan), {"m", "none"});
    const auto fill = [](const GridLayerWriter::Tile& tile, std::span<GridLayerWriter::TileValues> values) {
      for (const auto [r, c] : bins_of(tile)) {
        const auto at = static_cast<std::size_t>(r * tile.stride + c);
        const auto row = static_cast<int>(tile.first.row + r);
        std::get<std::vector<std::int32_t>>(values[0])[at] = 10 + row;
        std::get<std::vector<float>>(values[1])[at] = c == 3 ? kFloatNan : 0.1F * static_cast<float>(row);
      }
    };
    layers.write_tiled({{"count", h5::Type::int32, {"1", "count"}},
                        {"t", h5::Type::float32, {"s", "t"}},
                        {"empty", h5::Type::float64, {"m", "empty"}}},
                       fill);
    file.commit();
  }
  const LandfallFileReader file(folder / "a.h5", {"dem"});
  const Grid<double> z = waves(spec);
  double low = 1;
  double high = -1;
  for (const double value : z.values()) {
    low = std::fmin(low, value);
    high = std::fmax(high, value);
  }
  EXPECT_EQ(stored_range(file, "z", h5::Type::float64), (std::array{low, high}));
  EXPECT_EQ(stored_range(file, "flags", h5::Type::int8), (std::array{-7.0, 5.0}));
  EXPECT_EQ(stored_range(file, "none", h5::Type::float32), std::nullopt);
  EXPECT_EQ(stored_range(file, "count", h5::Type::int32), (std::array{10.0, 309.0}));
  EXPECT_EQ(stored_range(file, "t", h5::Type::float32), (std::array{0.0, double{0.1F * 299.0F}}));
  EXPECT_EQ(stored_range(file, "empty", h5::Type::float64), std::nullopt);
}

TEST(GridFile, ListsLayersInTheOrderOfTheirCreation) {
  const TemporaryFolder folder;
  write(folder / "a.h5", GridSpec::centered(3, 0.25), provenance());
  const LandfallFileReader file(folder / "a.h5", {"dem"});
  std::vector<std::string> names;
  const auto add = [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
    static_cast<std::vector<std::string>*>(list)->emplace_back(name);
    return 0;
  };
  ASSERT_GE(H5Literate(file.root(), H5_INDEX_CRT_ORDER, H5_ITER_INC, nullptr, add, &names), 0);
  EXPECT_THAT(names, testing::ElementsAre("provenance", "x", "y", "crs", "z", "count"));
}

TEST(GridFile, EqualRunsGiveEqualBytes) {
  const TemporaryFolder folder;
  write(folder / "a.h5", GridSpec::centered(3, 0.25), provenance());
  write(folder / "b.h5", GridSpec::centered(3, 0.25), provenance());
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
}

TEST(GridFile, ProvenanceTravels) {
  const TemporaryFolder folder;
  const Provenance made = provenance();
  write(folder / "a.h5", GridSpec::centered(3, 0.25), made);
  const LandfallFileReader file(folder / "a.h5", {"dem"});
  EXPECT_EQ(file.file_id(), made.file_id());
  EXPECT_EQ(file.config(), made.config);
  ASSERT_EQ(file.chain().size(), 1U);
  EXPECT_EQ(file.chain()[0], made.as_step());
}

TEST(GridFile, AnUncommittedFileDoesNotExist) {
  const TemporaryFolder folder;
  { const LandfallFileWriter file({folder / "a.h5", false, 1}, "dem", provenance()); }
  EXPECT_EQ(folder.entries(), 0U);
}

TEST(Provenance, IdDependsOnEveryPart) {
  const Provenance a = provenance();
  Provenance b = a;
  EXPECT_EQ(a.file_id(), b.file_id());
  b.config["a"] = 2;
  EXPECT_NE(a.file_id(), b.file_id());
  b = a;
  b.inputs[0].file_id = "abd";
  EXPECT_NE(a.file_id(), b.file_id());
  b = a;
  b.options = {{"keep_misses", true}};
  EXPECT_NE(a.file_id(), b.file_id());
  b = a;
  b.environment = {{"host", "x"}};
  EXPECT_EQ(a.file_id(), b.file_id());
}

TEST(Provenance, AStepReachedTwiceStandsOnce) {
  Provenance p = provenance();
  const nlohmann::json chain = {{{"tool", "terrain-gen"}}, {{"tool", "scan-sim"}}};
  p.add_input("scan", "1", chain);
  p.add_input("scan", "2", chain);
  EXPECT_EQ(p.chain.size(), 2U);
  EXPECT_EQ(p.inputs.size(), 3U);
}

// The data that was read counts, not the file's name: a raster may consist of several files.
TEST(Provenance, RasterIdIsOfWhatWasRead) {
  const auto raster = [](double sample, double cell) {
    return DemRaster{{{2, 2}, {1, 2, 3, sample}},
                     SiteMapping(GeoTransform({0, cell, 0, 0, 0, -cell}), {1, 1}, 1),
                     "frame",
                     {"a.tif", "GTiff", {2, 2}, 1}};
  };
  DemRaster renamed = raster(4, 1);
  renamed.source.path = "b.tif";
  EXPECT_EQ(raster_id(raster(4, 1)), raster_id(renamed));
  EXPECT_NE(raster_id(raster(4, 1)), raster_id(raster(5, 1)));
  EXPECT_NE(raster_id(raster(4, 1)), raster_id(raster(4, 2)));
}

}  // namespace
}  // namespace landfall
