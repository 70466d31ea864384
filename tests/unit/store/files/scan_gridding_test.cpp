// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "app/exports/small_scan.h"
#include "base/core/error.h"
#include "store/files/dem_file.h"
#include "store/files/point_positions.h"
#include "store/files/scan_gridding.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

/// Two files: returns at x = 1, 2, 2.5, 3 and at 1.25, 2.25, 2.75, 3.25; y = -x, z = 2 x.
class ScanGridding : public testing::Test {
 protected:
  ScanGridding() {
    SmallScan scan;
    scan.write(folder_ / "a.h5");
    for (double& x : scan.x) x += 0.25;
    scan.write(folder_ / "b.h5");
    for (const char* const name : {"a.h5", "b.h5"})
      scans_.push_back(std::make_unique<ScanReader>(folder_ / name));
  }

  /// The bin about (x, -x) of whole metres.
  static BinValues bin(const GriddedScans& gridded, std::int64_t x_m) {
    std::array<BinValues, 1> values{};
    gridded.bins->values({-x_m - kGrid.first_row, x_m - kGrid.first_col}, values);
    return values[0];
  }

  static constexpr GridSpec kGrid{1, -2, 0, 3, 3};  // y -2 .. 0, x 0 .. 2

  TemporaryFolder folder_;
  Scans scans_;
};

TEST_F(ScanGridding, AllScansAreInOneMap) {
  const GriddedScans gridded = grid_scans(scans_, {kGrid, Method::mean});
  EXPECT_EQ(gridded.nearest, nullptr);
  EXPECT_FALSE(gridded.moments.has_value());
  EXPECT_EQ(bin(gridded, 1).count, 2);
  EXPECT_DOUBLE_EQ(bin(gridded, 1).z_est, 2.25);
  EXPECT_DOUBLE_EQ(bin(gridded, 1).x_true, 101.125);
  EXPECT_EQ(bin(gridded, 2).count, 2);
  EXPECT_DOUBLE_EQ(bin(gridded, 2).z_est, 4.25);
  EXPECT_EQ(gridded.bins->inside_count(), 4);
  EXPECT_EQ(gridded.bins->outside_count(), 4);
}

// The second scan begins 2 s after the first: their returns about x = 1 m have the times 0 and 2 s.
TEST_F(ScanGridding, OpenedScansCountFromTheEarliestFirstPulse) {
  SmallScan scan{.t = {1.4e9, 1.4e9 + 0.25, 1.4e9 + 0.5}};
  scan.write(folder_ / "first.h5");
  for (double& x : scan.x) x += 0.25;
  for (double& t : scan.t) t += 2;
  scan.write(folder_ / "second.h5");
  Provenance provenance{.tool = "regrid"};
  const Scans scans = open_scans({folder_ / "second.h5", folder_ / "first.h5"}, provenance);
  for (const auto& opened : scans) EXPECT_EQ(opened->epoch_s(), 1.4e9);
  const GriddedScans gridded = grid_scans(scans, {kGrid, Method::mean});
  EXPECT_EQ(bin(gridded, 1).t, 1);
  {
    LandfallFileWriter file({folder_ / "dem.h5"}, "dem", provenance);
    write_dem(file, gridded, {.layers = {"t_mean"}, .epoch_s = scans.front()->epoch_s()}, "");
  }
  const LandfallFileReader dem(folder_ / "dem.h5", {"dem"});
  const h5::Handle layer = h5::open_dataset(dem.root(), "t_mean");
  EXPECT_EQ(h5::read_number_attribute(layer.get(), "epoch_s"), 1.4e9);
  const h5::Handle type(H5Dget_type(layer.get()), H5Tclose);
  EXPECT_EQ(H5Tget_size(type.get()), 8U);
}

// In the first scan, x = 2.5 lies on an edge of bins of 1 m; of 0.5 m: x = 1.25, 2.25, ... do.
TEST_F(ScanGridding, CountsReturnsOnEdges) {
  for (const Method method : {Method::mean, Method::median}) {
    const std::vector<EdgeSample> whole = grid_scans(scans_, {kGrid, method}).edges;
    ASSERT_EQ(whole.size(), 2U);
    EXPECT_EQ(whole[0].count, 4);
    EXPECT_EQ(whole[0].on_edge, 1);
    EXPECT_EQ(whole[1].on_edge, 0);
  }
  const std::vector<EdgeSample> half = grid_scans(scans_, {{0.5, -4, 0, 5, 5}, Method::mean}).edges;
  EXPECT_EQ(half[0].on_edge, 0);
  EXPECT_EQ(half[1].on_edge, 4);
}

TEST_F(ScanGridding, TheWeightedMeanHasItsMoments) {
  const GriddedScans gridded = grid_scans(scans_, {.grid = kGrid, .moments = true});
  ASSERT_EQ(gridded.nearest, gridded.bins.get());
  ASSERT_TRUE(gridded.moments.has_value());
  // Weights 1 and (1 - 1/4)^2 = 9/16.
  EXPECT_DOUBLE_EQ(bin(gridded, 1).weight_sum, 1 + 9. / 16);
  EXPECT_FLOAT_EQ(gridded.moments->bins()[kGrid.index({1, 1})].w_w, 1 + 81.F / 256);
}

TEST_F(ScanGridding, TheMedianSeesAllScansTwice) {
  std::vector<double> fractions;
  const GriddedScans gridded =
      grid_scans(scans_, {kGrid, Method::median}, [&](double fraction) { fractions.push_back(fraction); });
  EXPECT_EQ(bin(gridded, 2).count, 2);
  EXPECT_EQ(gridded.bins->inside_count(), 4);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.size(), 4U);
  EXPECT_EQ(fractions.back(), 1);
}

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
