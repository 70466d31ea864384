// SPDX-License-Identifier: GPL-3.0-or-later
// Each read of a file fails once: what is then told of the file is the same, or an error.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <functional>
#include <string>

#include "base/core/error.h"
#include "store/files/evaluation_file.h"
#include "store/files/file_description.h"
#include "store/files/table_reader.h"
#include "store/files/terrain_file.h"
#include "temporary_folder.h"

namespace {

// NOLINTBEGIN(*-avoid-non-const-global-variables)
long reads = 0;
long failing_read = 0;  // its number, from 1
// NOLINTEND(*-avoid-non-const-global-variables)

}  // namespace

// HDF5's own calls come here too, for a program's symbols go before those of its libraries.
extern "C" ssize_t pread(int file, void* data, size_t size, off_t offset) {
  using Pread = ssize_t (*)(int, void*, size_t, off_t);
  static const auto real = reinterpret_cast<Pread>(::dlsym(RTLD_NEXT, "pread"));
  if (++reads == failing_read) {
    errno = EIO;
    return -1;
  }
  return real(file, data, size, offset);
}

namespace landfall {
namespace {

const GridSpec kGrid{.resolution_m = 0.5, .first_row = -2, .first_col = -3, .rows = 4, .cols = 5};
using Tell = std::function<std::string(const std::filesystem::path&)>;

/// A file with all that a reader may go without: features, a CRS, a range, a history, flags.
void write_terrain_file(const std::filesystem::path& path) {
  Provenance provenance{.tool = "test", .config = {{"a", 1}}, .options = {{"b", 2}}};
  provenance.add_input("raster", "an id", {{{"tool", "t"}, {"file_id", "f"}}});
  Grid<double> nodes(kGrid);
  for (std::size_t i = 0; i < nodes.values().size(); ++i) nodes.values()[i] = static_cast<double>(i);
  LandfallFileWriter file({path, true, 1}, "terrain", provenance);
  write_terrain(file, {nodes, "LOCAL_CS[\"another\"]", {}, {{{1, 2, Rock{3, 1.25, 0.8, 0.5}}, -1, 0, 7.5}}});
}

void write_dem_file(const std::filesystem::path& path) {
  LandfallFileWriter file({path, true, 1}, "dem", {.tool = "test"});
  GridLayerWriter layers(file, kGrid, "");
  for (const char* const name : {"z_est", "x_true", "y_true", "z_true", "z_corrected"})
    layers.write(name, Grid<double>(kGrid), {"m", "a layer"});
  file.commit();
}

/// The answer of `tell` on the file with any one read failing: the same, or a FormatError that names the
/// file. Returns how often the latter.
int refusals(const std::filesystem::path& path, const Tell& tell) {
  reads = 0;
  const std::string whole = tell(path);
  const long count = reads;
  int refused = 0;
  for (long n = 1; n <= count; ++n) {
    reads = 0;
    failing_read = n;
    try {
      EXPECT_EQ(tell(path), whole) << "read " << n;
    } catch (const FormatError& error) {
      ++refused;
      const std::string text = error.what();
      EXPECT_EQ(text.rfind(path.string() + ": ", 0), 0U) << text;
      EXPECT_NE(text.find("Input/output error"), std::string::npos) << text;
    }
    failing_read = 0;
  }
  return refused;
}

TEST(FailingReads, DescriptionOfAFile) {
  const TemporaryFolder folder;
  write_terrain_file(folder / "a.h5");
  const auto tell = [](const auto& path) { return describe_file(path, {}).dump(); };
  EXPECT_GT(refusals(folder / "a.h5", tell), 20);
}

TEST(FailingReads, Terrain) {
  const TemporaryFolder folder;
  write_terrain_file(folder / "a.h5");
  const auto tell = [](const auto& path) {
    const TerrainInput terrain = read_terrain(path);
    const LandfallFileReader file(path, {"terrain"});
    const auto range = GridLayerReader(file).range("z").value_or(std::array{0.0, 0.0});
    return terrain.crs_wkt + terrain.file_id + terrain.chain.dump() + std::to_string(range[1]) +
           std::to_string(terrain.grid->nodes().values()[7]);
  };
  EXPECT_GT(refusals(folder / "a.h5", tell), 20);
}

TEST(FailingReads, KindOfAFile) {
  const TemporaryFolder folder;
  write_terrain_file(folder / "a.h5");
  const auto tell = [](const auto& path) { return std::to_string(is_landfall_file(path)); };
  EXPECT_GT(refusals(folder / "a.h5", tell), 1);
}

TEST(FailingReads, OptionalLayers) {
  const TemporaryFolder folder;
  write_dem_file(folder / "a.h5");
  const auto tell = [](const auto& path) {
    const DemInput dem = read_dem(path);
    return std::to_string(dem.layers.truth.has_value()) + std::to_string(dem.layers.corrected.has_value());
  };
  EXPECT_GT(refusals(folder / "a.h5", tell), 20);
}

TEST(FailingReads, MaskAndWhetherItIsOfTheGrid) {
  const TemporaryFolder folder;
  write_dem_file(folder / "a.h5");
  const auto tell = [](const auto& path) {
    const RegionMask mask = read_region_mask(path, "z_true", {"map", kGrid, kLocalSiteCrsWkt});
    return mask.file_id + std::to_string(mask.mask.values()[3]);
  };
  EXPECT_GT(refusals(folder / "a.h5", tell), 10);
}

TEST(FailingReads, OptionalColumns) {
  const TemporaryFolder folder;
  h5::initialise();
  {
    const h5::Handle file = h5::create_file(folder / "a.h5");
    const std::array<double, 2> values = {1, 2};
    for (const char* const name : {"t", "x"}) {
      const h5::Handle column =
          h5::create_dataset(file.get(), name, h5::Type::float64, {.size = {2}, .chunk = {}});
      H5Dwrite(column.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    }
  }
  const auto tell = [](const auto& path) {
    const NumberTable table = read_number_table(path, {{"t"}, {"x"}});
    return std::to_string(table.has("x"));
  };
  EXPECT_GT(refusals(folder / "a.h5", tell), 5);
}

}  // namespace
}  // namespace landfall
