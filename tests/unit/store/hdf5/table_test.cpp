// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/table.h"

#include <gtest/gtest.h>
#include <hdf5_hl.h>

#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "store/files/landfall_file.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

struct Rows {
  std::vector<double> x;
  std::vector<std::int32_t> n;
  std::vector<std::int8_t> f;
};

Rows make_rows(std::size_t count) {
  Rows rows;
  for (std::size_t i = 0; i < count; ++i) {
    rows.x.push_back(0.1 * static_cast<double>(i));
    rows.n.push_back(static_cast<std::int32_t>(i));
    rows.f.push_back(static_cast<std::int8_t>(i % 5));
  }
  return rows;
}

std::vector<ColumnSpec> columns() {
  return {{"x", h5::Type::float64, "m", "x"},
          {"x32", h5::Type::float32, "m", "x in single precision"},
          {"n", h5::Type::int32, "1", "n"},
          {"f", h5::Type::int8, "1", "f", {0, 1}, "zero one"}};
}

void write(const std::filesystem::path& path, const Rows& rows, std::size_t batch, int level) {
  LandfallFileWriter file({path, true, level}, "scan", {.tool = "test"});
  TableWriter table(file.root(), "points", columns(), level);
  for (std::size_t begin = 0; begin < rows.x.size(); begin += batch) {
    const std::size_t count = std::min(batch, rows.x.size() - begin);
    const std::span<const double> x = std::span(rows.x).subspan(begin, count);
    const std::array<ColumnRows, 4> piece = {x, x, std::span(rows.n).subspan(begin, count),
                                             std::span(rows.f).subspan(begin, count)};
    table.append(piece);
  }
  EXPECT_EQ(table.row_count(), rows.x.size());
  table.finish();
  file.commit();
}

// HDF5's own filters read what we compressed ourselves; several chunks and a part of one.
TEST(Table, RoundTripAtEveryLevel) {
  const TemporaryFolder folder;
  const Rows rows = make_rows(2 * kTableChunkRows + 17);
  for (const int level : {0, 1, 9}) {
    write(folder / "a.h5", rows, 1000, level);
    const LandfallFileReader file(folder / "a.h5", {"scan"});
    const TableReader table(file.root(), "points", file.name());
    ASSERT_EQ(table.row_count("x"), rows.x.size());
    std::vector<double> x(rows.x.size());
    std::vector<double> x32(1);
    std::vector<std::int32_t> n(5);
    std::vector<std::int8_t> f(rows.f.size());
    table.read("x", 0, std::span(x));
    table.read("x32", 12345, std::span(x32));
    table.read("n", kTableChunkRows - 2, std::span(n));
    table.read("f", 0, std::span(f));
    EXPECT_EQ(x, rows.x);
    EXPECT_EQ(x32[0], static_cast<double>(static_cast<float>(1234.5)));
    EXPECT_EQ(n.front(), static_cast<std::int32_t>(kTableChunkRows - 2));
    EXPECT_EQ(f, rows.f);
  }
}

hsize_t chunk_rows(hid_t dataset) {
  const h5::Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  hsize_t rows = 0;
  EXPECT_EQ(H5Pget_chunk(properties.get(), 1, &rows), 1);
  return rows;
}

TEST(Table, AShortOneHasOneChunkOfItsRows) {
  const TemporaryFolder folder;
  for (const auto& [count, expected] : {std::pair<std::size_t, std::size_t>{3, 3},
                                        {0, kTableChunkRows},
                                        {kTableChunkRows - 1, kTableChunkRows - 1},
                                        {kTableChunkRows + 1, kTableChunkRows}}) {
    const Rows rows = make_rows(count);
    write(folder / "a.h5", rows, 1000, 1);
    const LandfallFileReader file(folder / "a.h5", {"scan"});
    const TableReader table(file.root(), "points", file.name());
    const h5::Handle dataset = table.open("x");
    EXPECT_EQ(chunk_rows(dataset.get()), expected);
    EXPECT_TRUE(decodable_column(dataset.get(), count)) << count;
    std::vector<double> x(count);
    table.read("x", 0, std::span(x));
    EXPECT_EQ(x, rows.x);
  }
}

TEST(Table, AShortOneOfEarlierVersionsIsDecoded) {
  const TemporaryFolder folder;
  const Rows rows = make_rows(5);
  LandfallFileWriter writer({folder / "a.h5"}, "scan", {.tool = "test"});
  const h5::Handle group = h5::create_group(writer.root(), "points");
  const h5::Handle dataset =
      h5::create_dataset(group.get(), "x", h5::Type::float64,
                         {.size = {5}, .chunk = {kTableChunkRows}, .growing = true, .level = 1});
  ASSERT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.x.data()), 0);
  EXPECT_TRUE(decodable_column(dataset.get(), 5));
  const TableReader table(writer.root(), "points", "a.h5");
  std::vector<double> x(3);
  table.read("x", 2, std::span(x));
  EXPECT_EQ(x, std::vector<double>(rows.x.begin() + 2, rows.x.end()));
}

TEST(Table, StoresFloatsAsTheyAre) {
  const TemporaryFolder folder;
  const std::vector<float> values = {0.1F, -2.5F};
  LandfallFileWriter writer({folder / "a.h5"}, "scan", {.tool = "test"});
  const std::array<ColumnRows, 1> rows = {std::span(values)};
  write_table(writer.root(), "points", {{"v", h5::Type::float32, "1", "v"}}, rows, 1);
  writer.commit();
  const LandfallFileReader file(folder / "a.h5", {"scan"});
  const TableReader table(file.root(), "points", file.name());
  EXPECT_EQ(table.element_size("v"), sizeof(float));
  std::vector<double> read(2);
  table.read("v", 0, std::span(read));
  EXPECT_EQ(read, std::vector<double>(values.begin(), values.end()));
}

TEST(Table, BytesDependOnNeitherBatchesNorThreads) {
  const TemporaryFolder folder;
  const Rows rows = make_rows(kTableChunkRows + 5);
  write(folder / "a.h5", rows, 1, 1);
  const ThreadLimit limit(1);
  write(folder / "b.h5", rows, rows.x.size(), 1);
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
}

/// Writes `rows` with the columns x and n as `source` stores them; n has no rows of its own.
bool copy(const std::filesystem::path& path, const TableReader& source, const Rows& rows, int level) {
  LandfallFileWriter file({path, true, level}, "scan", {.tool = "test"});
  TableWriter table(file.root(), "points", columns(), level);
  constexpr std::array kCopied = {"x", "n"};
  if (!table.copy_columns(source, kCopied)) return false;
  std::vector<std::vector<TableWriter::ChunkPtr>> taken;
  const std::size_t middle = rows.x.size() * 2 / 3;
  for (const auto& [begin, count] :
       {std::pair<std::size_t, std::size_t>{0, middle}, {middle, rows.x.size() - middle}}) {
    const std::array<ColumnRows, 4> piece = {
        std::span(rows.x).subspan(begin, count), std::span(rows.x).subspan(begin, count),
        std::span<const std::int32_t>(), std::span(rows.f).subspan(begin, count)};
    taken.push_back(table.take(piece));
  }
  for (const auto& chunks : taken)  // all taken before the first is encoded
    for (const TableWriter::ChunkPtr& chunk : chunks) table.encode(*chunk);
  for (const auto& chunks : taken)
    for (const TableWriter::ChunkPtr& chunk : chunks) table.write(chunk);
  table.finish();
  file.commit();
  return true;
}

TEST(Table, CopiedColumnsGiveTheSameFile) {
  const TemporaryFolder folder;
  const Rows rows = make_rows(3 * kTableChunkRows + 17);
  write(folder / "a.h5", rows, 1000, 1);
  const LandfallFileReader file(folder / "a.h5", {"scan"});
  const TableReader source(file.root(), "points", file.name());
  EXPECT_TRUE(copy(folder / "b.h5", source, rows, 1));
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
  EXPECT_FALSE(copy(folder / "c.h5", source, rows, 2));
  EXPECT_THROW(copy(folder / "c.h5", source, make_rows(3 * kTableChunkRows), 1), FormatError);
}

TEST(Table, CopiedColumnsOfAShortTableGiveTheSameFile) {
  const TemporaryFolder folder;
  const Rows rows = make_rows(17);
  write(folder / "a.h5", rows, 5, 1);
  const LandfallFileReader file(folder / "a.h5", {"scan"});
  const TableReader source(file.root(), "points", file.name());
  EXPECT_TRUE(copy(folder / "b.h5", source, rows, 1));
  EXPECT_EQ(read_file(folder / "a.h5"), read_file(folder / "b.h5"));
  EXPECT_THROW(copy(folder / "c.h5", source, make_rows(16), 1), FormatError);
}

TEST(Table, ItsRowsHaveANamedDimensionWithoutValues) {
  const TemporaryFolder folder;
  for (const std::size_t count : {std::size_t{0}, std::size_t{3}}) {
    {
      LandfallFileWriter file({folder / "a.h5", true, 1}, "scan", {.tool = "test"});
      const Rows rows = make_rows(count);
      const std::array<ColumnRows, 4> all = {std::span<const double>(rows.x), std::span<const double>(rows.x),
                                             std::span<const std::int32_t>(rows.n),
                                             std::span<const std::int8_t>(rows.f)};
      write_table(file.root(), "points", columns(), all, 1);
      name_rows(file.root(), "points", "point");
      file.commit();
    }
    const LandfallFileReader file(folder / "a.h5", {"scan"});
    const h5::Handle scale = h5::open_dataset(file.root(), "point");
    EXPECT_GT(H5DSis_scale(scale.get()), 0);
    EXPECT_EQ(h5::stored_bytes(scale.get()), 0U);
    const TableReader points(file.root(), "points", file.name());
    for (const ColumnSpec& column : columns()) {
      EXPECT_GT(H5DSis_attached(points.open(column.name).get(), scale.get(), 0), 0) << column.name;
      EXPECT_EQ(points.row_count(column.name), count);
    }
  }
}

TEST(Table, NamesWhatIsMissing) {
  const TemporaryFolder folder;
  write(folder / "a.h5", make_rows(3), 3, 1);
  const LandfallFileReader file(folder / "a.h5", {"scan"});
  EXPECT_THROW(TableReader(file.root(), "pulses", file.name()), FormatError);
  const TableReader table(file.root(), "points", file.name());
  EXPECT_THROW(static_cast<void>(table.row_count("y")), FormatError);
  std::vector<double> x(4);
  EXPECT_THROW(table.read("x", 0, std::span(x)), FormatError);  // beyond the end
}

}  // namespace
}  // namespace landfall
