// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/column_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <set>
#include <string>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "refusal.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

constexpr std::size_t kRows = 2 * kTableChunkRows + 1234;

double x_of(std::size_t row) { return 0.125 * static_cast<double>(row % 100000) - 7; }

/// A file of columns of kRows rows, x_of(row) in each, in whatever form.
class ColumnReaderTest : public testing::Test {
 protected:
  ColumnReaderTest() : file_(h5::create_file(folder_ / "a.h5")) {
    for (std::size_t i = 0; i < kRows; ++i) x_.push_back(x_of(i));
  }

  void write_table_columns(int level) {
    std::vector<std::int32_t> n(kRows);
    std::iota(n.begin(), n.end(), 0);
    std::vector<std::int8_t> f(kRows);
    for (std::size_t i = 0; i < kRows; ++i) f[i] = static_cast<std::int8_t>(i % 7);
    const std::span<const double> x = x_;
    const std::array<ColumnRows, 4> rows = {x, x, std::span<const std::int32_t>(n),
                                            std::span<const std::int8_t>(f)};
    write_table(file_.get(), "points",
                {{"x", h5::Type::float64, "m", "x"},
                 {"x32", h5::Type::float32, "m", "x"},
                 {"n", h5::Type::int32, "1", "n"},
                 {"f", h5::Type::int8, "1", "f"}},
                rows, level);
  }

  /// Written by HDF5 itself; chunk 0: contiguous.
  h5::Handle write_plainly(const std::string& name, hid_t type, hsize_t chunk,
                           const std::function<void(hid_t)>& set_filters = {}) {
    const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    if (chunk > 0) H5Pset_chunk(properties.get(), 1, &chunk);
    if (set_filters) set_filters(properties.get());
    const hsize_t size = kRows;
    const h5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
    h5::Handle dataset(
        H5Dcreate2(file_.get(), name.c_str(), type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
        H5Dclose);
    EXPECT_GE(H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, x_.data()), 0);
    return dataset;
  }

  [[nodiscard]] TableReader table(const std::string& group) const { return {file_.get(), group, "a.h5"}; }

  std::vector<double> read_all(const std::string& name) {
    std::vector<double> x(kRows);
    table("/").read(name, 0, std::span(x));
    return x;
  }

  TemporaryFolder folder_;
  h5::Handle file_;
  std::vector<double> x_;
};

TEST_F(ColumnReaderTest, BatchesOfAnyLengthGiveTheColumns) {
  for (const int level : {0, 1, 6}) {
    if (level > 0) H5Ldelete(file_.get(), "points", H5P_DEFAULT);
    write_table_columns(level);
    const TableReader points = table("points");
    for (const std::size_t batch :
         {std::size_t{1000}, std::size_t{65448}, kTableChunkRows, 2 * kTableChunkRows + 1, kRows}) {
      ColumnReader reader(points, {"x", "f", "n", "x32"});
      for (std::size_t begin = 0; begin < kRows; begin += batch) {
        const std::size_t count = std::min(batch, kRows - begin);
        std::vector<double> x(count);
        std::vector<double> x32(count);
        std::vector<std::int32_t> n(count);
        std::vector<std::int8_t> f(count);
        const std::array<ColumnTarget, 4> targets = {std::span(x), std::span(f), std::span(n),
                                                     std::span(x32)};
        reader.read(begin, targets);
        for (std::size_t i = 0; i < count; ++i) {
          ASSERT_EQ(x[i], x_[begin + i]) << "row " << begin + i << ", batches of " << batch;
          ASSERT_EQ(x32[i], static_cast<double>(static_cast<float>(x_[begin + i])));
          ASSERT_EQ(n[i], static_cast<std::int32_t>(begin + i));
          ASSERT_EQ(f[i], static_cast<std::int8_t>((begin + i) % 7));
        }
      }
    }
  }
}

TEST_F(ColumnReaderTest, ReadsBackwardsToo) {
  write_table_columns(1);
  const TableReader points = table("points");
  ColumnReader reader(points, {"x"});
  for (std::size_t begin = kRows - 10; begin > 5000; begin -= 5000) {
    std::vector<double> x(3);
    const std::array<ColumnTarget, 1> targets = {std::span(x)};
    reader.read(begin, targets);
    ASSERT_EQ(x[2], x_[begin + 2]);
  }
}

TEST_F(ColumnReaderTest, OtherFormsGoThroughHdf5) {
  const auto deflate = [](hid_t p) { H5Pset_deflate(p, 1); };
  const auto checked = [](hid_t p) { H5Pset_shuffle(p), H5Pset_deflate(p, 1), H5Pset_fletcher32(p); };
  const auto ours = [](hid_t p) { H5Pset_shuffle(p), H5Pset_deflate(p, 1); };
  write_plainly("contiguous", H5T_IEEE_F64LE, 0);
  write_plainly("big_endian", H5T_IEEE_F64BE, kTableChunkRows, ours);
  write_plainly("only_deflate", H5T_IEEE_F64LE, kTableChunkRows, deflate);
  write_plainly("fletcher", H5T_IEEE_F64LE, kTableChunkRows, checked);
  write_plainly("small_chunks", H5T_IEEE_F64LE, 1000, ours);
  write_plainly("ours", H5T_IEEE_F64LE, kTableChunkRows, ours);
  const std::set<std::string> decodable = {"only_deflate", "ours"};
  for (const char* const name :
       {"contiguous", "big_endian", "only_deflate", "fletcher", "small_chunks", "ours"}) {
    const h5::Handle dataset = table("/").open(name);
    const hsize_t chunk[] = {kTableChunkRows};
    EXPECT_EQ(decodable_chunks(dataset.get(), chunk).has_value(), decodable.contains(name)) << name;
    EXPECT_EQ(read_all(name), x_) << name;
  }
}

TEST_F(ColumnReaderTest, AColumnOfAnotherTypeIsConverted) {
  write_table_columns(1);
  std::vector<std::int64_t> n(5);
  table("points").read("n", kTableChunkRows - 2, std::span(n));
  EXPECT_THAT(n, testing::ElementsAre(65534, 65535, 65536, 65537, 65538));
}

TEST_F(ColumnReaderTest, AChunkThatWasNeverWrittenHoldsTheFillValue) {
  const auto ours = [](hid_t p) {
    const double fill = 4.5;
    H5Pset_fill_value(p, H5T_NATIVE_DOUBLE, &fill), H5Pset_shuffle(p), H5Pset_deflate(p, 1);
  };
  const hsize_t chunk = kTableChunkRows;
  const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.get(), 1, &chunk);
  ours(properties.get());
  const hsize_t size = kRows;
  const h5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const h5::Handle dataset(H5Dcreate2(file_.get(), "sparse", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                                      properties.get(), H5P_DEFAULT),
                           H5Dclose);
  EXPECT_EQ(read_all("sparse"), std::vector<double>(kRows, 4.5));
}

TEST_F(ColumnReaderTest, ChunksThatSkipAFilterAreRead) {
  const h5::Handle dataset = write_plainly("x", H5T_IEEE_F64LE, kTableChunkRows,
                                           [](hid_t p) { H5Pset_shuffle(p), H5Pset_deflate(p, 1); });
  const hsize_t offset = kTableChunkRows;  // this chunk: neither filter
  ASSERT_GE(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, 3, &offset, 8 * kTableChunkRows, x_.data()), 0);
  std::vector<double> expected = x_;
  std::copy_n(x_.begin(), kTableChunkRows, expected.begin() + kTableChunkRows);
  EXPECT_EQ(read_all("x"), expected);
}

TEST_F(ColumnReaderTest, ACorruptChunkNamesFileAndColumn) {
  const h5::Handle dataset = write_plainly("x", H5T_IEEE_F64LE, kTableChunkRows,
                                           [](hid_t p) { H5Pset_shuffle(p), H5Pset_deflate(p, 1); });
  const hsize_t offset = kTableChunkRows;
  for (const std::size_t size : {std::size_t{100}, 8 * (kTableChunkRows - 1)}) {
    const unsigned mask = size == 100 ? 0 : 3;  // no zlib stream; plain, but too short
    ASSERT_GE(H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, mask, &offset, size, x_.data()), 0);
    EXPECT_EQ(refusal<FormatError>([&] { read_all("x"); }),
              "a.h5: reading /x failed: the chunk at row 65536 is corrupt");
    std::vector<double> first(10);
    table("/").read("x", 0, std::span(first));  // the other chunks are whole
    EXPECT_EQ(first[9], x_[9]);
  }
}

TEST_F(ColumnReaderTest, RowsBeyondTheEndAreRefused) {
  write_table_columns(1);
  std::vector<double> x(2);
  EXPECT_THROW(table("points").read("x", kRows - 1, std::span(x)), FormatError);
  EXPECT_THROW(table("points").read("x", SIZE_MAX, std::span(x)), FormatError);
}

TEST_F(ColumnReaderTest, OneThreadReadsTheSame) {
  write_table_columns(1);
  const ThreadLimit limit(1);
  std::vector<double> x(kRows);
  table("points").read("x", 0, std::span(x));
  EXPECT_EQ(x, x_);
}

}  // namespace
}  // namespace landfall
