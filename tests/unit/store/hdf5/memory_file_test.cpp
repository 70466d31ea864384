// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/memory_file.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <numeric>

#include "base/core/error.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr const char* kName = "some map in memory.h5";
constexpr GridSpec kWide{0.5, -300, -2, 600, 5};  // two rows of tiles

Grid<float> numbered() {
  Grid<float> layer(kWide);
  std::iota(layer.values().begin(), layer.values().end(), 0.25F);
  return layer;
}

std::vector<double> column() {
  std::vector<double> values(kTableChunkRows + 3);
  std::iota(values.begin(), values.end(), -7.0);
  return values;
}

void write(const std::filesystem::path& path) {
  LandfallFileWriter file({path}, "dem", {.tool = "test"});
  GridLayerWriter(file, kWide, "").write("z_spread", numbered());
  const std::vector<double> x = column();
  const std::array<ColumnRows, 1> rows = {std::span<const double>(x)};
  write_table(file.root(), "points", {{"x", h5::Type::float64, "m", "x"}}, rows, file.compression());
  file.commit();
}

void expect_content(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"dem"});
  EXPECT_TRUE(
      std::ranges::equal(GridLayerReader(file).read<float>("z_spread").values(), numbered().values()));
  EXPECT_EQ(GridLayerReader(file).read<double>("z_spread").at({1, 1}), 6.25);
  const TableReader points(file.root(), "points", file.name());
  std::vector<double> found(4);
  points.read("x", kTableChunkRows - 1, std::span(found));
  EXPECT_THAT(found, testing::ElementsAre(65528, 65529, 65530, 65531));
}

TEST(MemoryFile, IsReadAsAFileAndSavedAsOne) {
  TemporaryFolder folder;
  h5::MemoryFile memory(kName);
  EXPECT_THAT([] { LandfallFileReader(kName, {"dem"}); },
              ThrowsMessage<FormatError>(HasSubstr("no content")));
  write(kName);
  EXPECT_FALSE(std::filesystem::exists(kName));
  expect_content(kName);
  const auto layer = memory.array("/z_spread");
  ASSERT_NE(layer, nullptr);
  EXPECT_THAT(layer->shape, testing::ElementsAre(600, 5));
  EXPECT_EQ(memory.array("/x"), nullptr);
  save_file(memory, {folder / "saved.h5"});
  write(folder / "written.h5");
  check_file(folder / "saved.h5");
  expect_content(folder / "saved.h5");
  EXPECT_NEAR(static_cast<double>(std::filesystem::file_size(folder / "saved.h5")),
              static_cast<double>(std::filesystem::file_size(folder / "written.h5")), 4096);
  EXPECT_THROW(save_file(memory, {folder / "saved.h5"}), UsageError);
  h5::MemoryFile loaded("a loaded map.h5");
  loaded.load(folder / "saved.h5");
  std::filesystem::remove(folder / "saved.h5");
  expect_content(loaded.name());
  EXPECT_THROW(loaded.load(folder / "saved.h5"), FormatError);
}

TEST(GrowingBytes, KeepTheirValues) {
  h5::GrowingBytes bytes;
  std::size_t filled = 0;
  const auto value = [](std::size_t i) { return static_cast<std::byte>(i % 251); };
  for (const std::size_t size : {100U, 5U << 10U, 3U << 20U, 7U << 20U, 40U << 20U, 1U << 20U}) {
    bytes.resize(size);
    for (; filled < size; ++filled) bytes.data()[filled] = value(filled);
    for (std::size_t i = 0; i < size; i += 997) ASSERT_EQ(bytes.data()[i], value(i)) << size;
  }
}

TEST(MemoryFile, ArraysOutliveItAndNamesAreFreed) {
  std::shared_ptr<const h5::MemoryArray> layer;
  {
    h5::MemoryFile memory(kName);
    EXPECT_THROW(h5::MemoryFile{kName}, UsageError);
    write(kName);
    layer = memory.array("/z_spread");
    write(kName);  // again, as another file
    EXPECT_NE(memory.array("/z_spread"), layer);
  }
  EXPECT_EQ(layer->values.size(), kWide.size() * sizeof(float));
  EXPECT_THAT([] { LandfallFileReader(kName, {"dem"}); }, ThrowsMessage<FormatError>(HasSubstr(kName)));
}

}  // namespace
}  // namespace landfall
