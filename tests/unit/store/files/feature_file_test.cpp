// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/terrain_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>
#include <span>
#include <sstream>

#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::_;
using testing::ElementsAre;
using testing::IsNan;

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

template <class T>
std::vector<T> read(const std::filesystem::path& path, const char* column) {
  const LandfallFileReader file(path, {"terrain"});
  const TableReader table(file.root(), "features", file.name());
  std::vector<T> values(table.row_count(column));
  table.read(column, 0, std::span(values));
  return values;
}

TEST(FeatureFile, RoundTrip) {
  const TemporaryFolder folder;
  write(folder / "a.h5", one_of_each());
  const auto path = folder / "a.h5";
  EXPECT_THAT(read<double>(path, "x"), ElementsAre(1, -100, 0));
  EXPECT_THAT(read<double>(path, "y"), ElementsAre(2, 0, -3));
  EXPECT_THAT(read<double>(path, "ground"), ElementsAre(7.5, IsNan(), -0.25));
  EXPECT_THAT(read<double>(path, "diameter"), ElementsAre(3, 10, _));
  EXPECT_THAT(read<double>(path, "height"), ElementsAre(1.25, -0.75, _));
  EXPECT_THAT(read<double>(path, "yaw"), ElementsAre(0.5, _, _));
  EXPECT_THAT(read<std::int32_t>(path, "pattern"), ElementsAre(-1, -1, 2));
  EXPECT_THAT(read<std::int64_t>(path, "number"), ElementsAre(0, 1, 4'000'000'000));
  const LandfallFileReader file(path, {"terrain"});
  const h5::Handle kind = h5::open_dataset(file.root(), "features/kind");
  std::istringstream words(h5::read_text_attribute(kind.get(), "flag_meanings").value());
  const std::vector<std::string> kinds(std::istream_iterator<std::string>(words), {});
  std::vector<std::string> found;
  for (const std::int8_t index : read<std::int8_t>(path, "kind"))
    found.push_back(kinds.at(static_cast<std::size_t>(index)));
  EXPECT_THAT(found, ElementsAre("rock", "crater", "penitente_field"));
}

TEST(FeatureFile, ManyRows) {
  const TemporaryFolder folder;
  std::vector<PlacedFeature> features;
  for (std::int64_t i = 0; i < 2 * static_cast<std::int64_t>(kTableChunkRows) + 5; ++i)
    features.push_back({{0.5 * static_cast<double>(i), 0, Rock{}}, 0, i, 0.0});
  write(folder / "a.h5", features);
  const auto x_m = read<double>(folder / "a.h5", "x");
  const auto number = read<std::int64_t>(folder / "a.h5", "number");
  ASSERT_EQ(number.size(), features.size());
  for (std::size_t i = 0; i < number.size(); ++i) {
    ASSERT_EQ(x_m[i], features[i].feature.x_m);
    ASSERT_EQ(number[i], features[i].number);
  }
}

TEST(FeatureFile, NoObjectsNoGroup) {
  const TemporaryFolder folder;
  write(folder / "a.h5", {});
  const LandfallFileReader file(folder / "a.h5", {"terrain"});
  EXPECT_FALSE(h5::exists(file.root(), "features"));
}

}  // namespace
}  // namespace landfall
