// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/scan_gridding.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "app/exports/small_scan.h"
#include "store/files/dem_file.h"
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

}  // namespace
}  // namespace landfall
