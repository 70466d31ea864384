// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/feature_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

std::vector<PlacedFeature> one_of_each() {
  return {{{1, 2, Rock{3, 1.25, 0.8, 0.5}}, -1, 0, 7.5},
          {{-100, 0, Crater{10, 1.5, 0.5}}, -1, 1, std::nullopt},
          {{0, -3, PenitenteField{}}, 2, 4'000'000'000, -0.25}};
}

void write(const std::filesystem::path& path, const std::vector<PlacedFeature>& features) {
  LandfallFileWriter file({path, true, 1}, "terrain", {.tool = "test"});
  write_features(file, features);
  file.commit();
}

std::vector<FeatureRecord> read(const std::filesystem::path& path) {
  return read_features(LandfallFileReader(path, {"terrain"}));
}

TEST(FeatureFile, RoundTrip) {
  const TemporaryFolder folder;
  write(folder / "a.h5", one_of_each());
  const auto records = read(folder / "a.h5");
  ASSERT_EQ(records.size(), 3U);
  EXPECT_EQ(records[0].kind, "rock");
  EXPECT_EQ(records[0].x_m, 1);
  EXPECT_EQ(records[0].y_m, 2);
  EXPECT_EQ(records[0].ground_m, 7.5);
  EXPECT_EQ(records[0].size.diameter_m, 3);
  EXPECT_EQ(records[0].size.height_m, 1.25);
  EXPECT_EQ(records[0].size.yaw_rad, 0.5);
  EXPECT_EQ(records[0].pattern, -1);
  EXPECT_EQ(records[1].kind, "crater");
  EXPECT_EQ(records[1].size.height_m, -0.75);
  EXPECT_TRUE(std::isnan(records[1].ground_m));
  EXPECT_EQ(records[1].number, 1);
  EXPECT_EQ(records[2].kind, "penitente_field");
  EXPECT_EQ(records[2].pattern, 2);
  EXPECT_EQ(records[2].number, 4'000'000'000);
}

TEST(FeatureFile, ManyRows) {
  const TemporaryFolder folder;
  std::vector<PlacedFeature> features;
  for (std::int64_t i = 0; i < 2 * static_cast<std::int64_t>(kTableChunkRows) + 5; ++i)
    features.push_back({{0.5 * static_cast<double>(i), 0, Rock{}}, 0, i, 0.0});
  write(folder / "a.h5", features);
  const auto records = read(folder / "a.h5");
  ASSERT_EQ(records.size(), features.size());
  for (std::size_t i = 0; i < records.size(); i += 1111) {
    EXPECT_EQ(records[i].x_m, features[i].feature.x_m);
    EXPECT_EQ(records[i].number, features[i].number);
  }
  EXPECT_EQ(records.back().number, features.back().number);
}

TEST(FeatureFile, NoObjectsNoGroup) {
  const TemporaryFolder folder;
  write(folder / "a.h5", {});
  const LandfallFileReader file(folder / "a.h5", {"terrain"});
  EXPECT_FALSE(h5::exists(file.root(), "features"));
  EXPECT_TRUE(read_features(file).empty());
}

/// A /features with `kind_count` rows of `kind`, 2 of all else.
void write_odd(const std::filesystem::path& path, std::size_t kind_count, std::int8_t kind) {
  LandfallFileWriter file({path, true, 1}, "terrain", {.tool = "test"});
  const h5::Handle group = h5::create_group(file.root(), "features");
  const auto put = [&](const char* name, h5::Type type, const void* values, hsize_t count) {
    const h5::Handle column = h5::create_dataset(group.get(), name, type, {.size = {count}, .chunk = {}});
    if (std::string(name) == "kind") h5::write_attribute(column.get(), "flag_meanings", "cone rock");
    H5Dwrite(column.get(), h5::native(type), H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  };
  const std::array<double, 2> reals = {1, 2};
  for (const char* const name : {"x", "y", "ground", "diameter", "height", "yaw"})
    put(name, h5::Type::float64, reals.data(), 2);
  const std::array<std::int32_t, 2> patterns = {-1, -1};
  put("pattern", h5::Type::int32, patterns.data(), 2);
  const std::array<std::int64_t, 2> numbers = {0, 1};
  put("number", h5::Type::int64, numbers.data(), 2);
  const std::vector<std::int8_t> kinds(kind_count, kind);
  put("kind", h5::Type::int8, kinds.data(), kind_count);
  file.commit();
}

TEST(FeatureFile, RefusesColumnsThatDoNotFit) {
  const TemporaryFolder folder;
  const auto refusal = [&](std::size_t kind_count, std::int8_t kind) -> std::string {
    write_odd(folder / "a.h5", kind_count, kind);
    try {
      static_cast<void>(read(folder / "a.h5"));
    } catch (const FormatError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(refusal(2, 1), "accepted");
  EXPECT_THAT(refusal(2, 2), ::testing::HasSubstr("/features/kind failed: row 0 has the value 2"));
  EXPECT_THAT(refusal(2, -1), ::testing::HasSubstr("the value -1"));
  EXPECT_THAT(refusal(3, 1), ::testing::HasSubstr("/features/kind failed: it has 3 rows, x has 2"));
}

}  // namespace
}  // namespace landfall
