// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/point_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "base/core/error.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

constexpr std::size_t kRows = 70000;  // more than a chunk

/// `/points` of x = 0, 1, ..., y = 100000 + x and z = 200000 + x, z in single precision.
void write_scan(const std::filesystem::path& path) {
  h5::Handle file = h5::create_file(path);
  const h5::Handle points = h5::create_group(file.get(), "points");
  std::vector<double> values(kRows);
  double first = 0;
  for (const char* const name : {"x", "y", "z"}) {
    std::iota(values.begin(), values.end(), first);
    first += 100000;
    const h5::Handle column =
        h5::create_dataset(points.get(), name, *name == 'z' ? h5::Type::float32 : h5::Type::float64,
                           {.size = {kRows}, .chunk = {4096}, .level = 1});
    ASSERT_GE(H5Dwrite(column.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  }
}

/// As other programs do it: landfall itself opens no file that another one names.
std::vector<double> read_dataset(const std::filesystem::path& path, const char* dataset) {
  const h5::Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  const h5::Handle data(H5Dopen2(file.get(), dataset, H5P_DEFAULT), H5Dclose);
  const h5::Handle space(H5Dget_space(data.get()), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.get())));
  EXPECT_GE(H5Dread(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), 0);
  return values;
}

PointPositions positions(const std::string& scan) {
  return {scan, {"x", "y", "z"}, h5::Type::float64, kRows, "id"};
}

void write_places(const std::filesystem::path& path, const PointPositions& positions) {
  OutputPath output(path, false);
  write_point_positions(output, positions, "tool", 1);
  output.commit();
}

TEST(PointPositions, ShowTheColumnsSideBySideWithoutHoldingThem) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "below");
  write_scan(folder / "below/50%b.h5");  // a pattern, were it not escaped
  write_places(folder / "p.h5", positions("below/50%b.h5"));
  const std::vector<double> position = read_dataset(folder / "p.h5", "position");
  const std::vector<double> row = read_dataset(folder / "p.h5", "row");
  ASSERT_EQ(position.size(), 3 * kRows);
  ASSERT_EQ(row.size(), kRows);
  for (std::size_t i = 0; i < kRows; ++i) {
    const auto value = static_cast<double>(i);
    ASSERT_EQ(row[i], value);
    for (std::size_t axis = 0; axis < 3; ++axis)
      ASSERT_EQ(position[3 * i + axis], value + 100000 * static_cast<double>(axis));
  }
  EXPECT_LT(std::filesystem::file_size(folder / "p.h5"), kRows);
}

TEST(PointPositions, MayBeFewerThanAChunk) {
  const TemporaryFolder folder;
  PointPositions one = positions("scan.h5");
  one.rows = 1;
  write_places(folder / "p.h5", one);
  EXPECT_EQ(read_dataset(folder / "p.h5", "row"), std::vector<double>{0});
}

TEST(PointPositions, AreNoneWhereTheScanIsNot) {
  const TemporaryFolder folder;
  write_places(folder / "p.h5", positions("gone.h5"));
  for (const double value : read_dataset(folder / "p.h5", "position")) ASSERT_TRUE(std::isnan(value));
}

TEST(PointPositions, HaveEqualBytes) {
  const TemporaryFolder folder;
  write_places(folder / "p.h5", positions("scan.h5"));
  write_places(folder / "q.h5", positions("scan.h5"));
  EXPECT_EQ(read_file(folder / "p.h5"), read_file(folder / "q.h5"));
}

TEST(PointPositions, AppearWholeOrNotAtAll) {
  const TemporaryFolder folder;
  write_places(folder / "p.h5", positions("scan.h5"));
  const std::string before = read_file(folder / "p.h5");
  EXPECT_THROW(write_places(folder / "p.h5", positions("other.h5")), UsageError);
  EXPECT_EQ(read_file(folder / "p.h5"), before);
  EXPECT_EQ(folder.entries(), 1U);
}

TEST(PointPositions, CountRowsInTheSmallestTypeThatHoldsThem) {
  EXPECT_EQ(row_type(2147483647), h5::Type::int32);
  EXPECT_EQ(row_type(2147483648), h5::Type::int64);
}

}  // namespace
}  // namespace landfall
