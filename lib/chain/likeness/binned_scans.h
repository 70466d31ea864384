// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/raster/grid.h"
#include "chain/likeness/two_samples.h"

namespace landfall {

/// A quantity of each return, in the order of the returns; NaN where a return has none.
struct ReturnQuantity {
  std::string name = {};
  std::string unit = {};
  enum class Kind {
    value,     ///< its median is shown
    error,     ///< it lies about 0: its NMAD about 0 is shown
    relative,  ///< its unit is the instrument's own: divided by its median it is compared
  } kind = Kind::value;
  std::vector<double> values = {};
};

/// The returns of a scan in the order of their times, metres in a frame that two scans share.
struct ComparedScan {
  std::vector<double> x, y, z;
  std::vector<double> t;                   ///< seconds; empty: not known
  std::vector<std::int8_t> number;         ///< of the return of its pulse, 1 the first; empty: all are first
  std::vector<double> px, py, pz;          ///< of the lidar at the pulse of each return; empty: not known
  std::vector<ReturnQuantity> quantities;  ///< what else is known of the returns
};

/// The returns of one side in a bin.
struct ReturnSum {
  double count = 0, x = 0, y = 0, z = 0;                   ///< sums
  double first = std::numeric_limits<double>::infinity();  ///< share of the scan's duration at the first
  void add(const ReturnSum& other);
};
using ReturnSums = std::array<std::vector<ReturnSum>, 2>;

/// dz/dx and dz/dy.
struct Gradient {
  double x = std::numeric_limits<double>::quiet_NaN();
  double y = std::numeric_limits<double>::quiet_NaN();
};

/// The returns of two scans in bins of one lattice, per block.
class BinnedScans {
 public:
  BinnedScans(const ComparedScan& a, const ComparedScan& b, double posting_m);

  /// Bins that a return of either scan lies in, in the order of all bins below.
  [[nodiscard]] const std::vector<BinIndex>& bins() const { return bins_; }
  [[nodiscard]] double posting_m() const { return lattice_.resolution_m; }
  /// The number of the bin at a place; none if no return lies in it.
  [[nodiscard]] std::optional<std::size_t> number_at(double x, double y) const;
  [[nodiscard]] ReturnSums sums(const Sides& sides) const;
  /// The bin of each return of scan 0 or 1.
  [[nodiscard]] const std::vector<std::uint32_t>& bin_of_return(std::size_t scan) const {
    return bin_of_return_.at(scan);
  }
  /// The mean share of the bins of the smaller one of two blocks k that the other one covers too.
  [[nodiscard]] double block_overlap() const;
  /// The gradient of the surface of both scans at each bin, whatever the height between them: each scan's
  /// mean positions in the 3 x 3 bins about it, from its mean position in the bin, fitted together by least
  /// squares, weighted by returns. Along a direction in which they scatter by less than a tenth of what they
  /// do along the other, it is 0. NaN without a neighbour.
  [[nodiscard]] std::vector<Gradient> gradients() const;

 private:
  struct Entry {
    std::uint32_t bin;
    BlockOfScan block;
    ReturnSum sum;
  };
  void add(const ComparedScan& scan, std::size_t which);
  [[nodiscard]] std::uint32_t number_of(const BinIndex& bin);
  [[nodiscard]] const std::uint32_t* find(const BinIndex& bin) const;
  [[nodiscard]] Gradient gradient_at(std::uint32_t bin, const ReturnSums& sums) const;

  GridSpec lattice_;
  std::vector<BinIndex> bins_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;
  std::vector<Entry> entries_;
  std::array<std::vector<std::uint32_t>, 2> bin_of_return_;
};

/// Differences of the maps of both sides.
struct CoverageDifference {
  double counts_ks = 0;      ///< KS distance of the returns per bin, over the bins of both
  double decorrelation = 0;  ///< 1 - Pearson's correlation of the returns per bin
  double only_one = 0;       ///< share of the bins that only one side covers
  double over_time = 0;      ///< largest difference of covered_over_time()
};
[[nodiscard]] CoverageDifference coverage_difference(const ReturnSums& sums);

/// The share of the finally covered bins that are covered after k tenths of the duration, k = 1 .. 10.
[[nodiscard]] std::array<double, 10> covered_over_time(const std::vector<ReturnSum>& sums);

/// Side 1 less side 0 in the bins that both cover and that have a gradient g: d = z_1 - z_0 - g . (p_1 - p_0)
/// of the mean positions, so that it is 0 on a plane for any places of the returns.
struct SurfaceDifference {
  std::size_t bins = 0;
  double median_m = std::numeric_limits<double>::quiet_NaN(), nmad_m = median_m, p95_m = median_m;
  double shift_x_m = median_m, shift_y_m = median_m;    ///< of side 1, which gives d = -g . shift
  double tilt_x_rad = median_m, tilt_y_rad = median_m;  ///< d grows so much along x and along y
};

/// Median, NMAD and 0.95 quantile of |d|; shift and tilt by least squares of d = z + tilt . p - g . shift
/// (Nuth and Kaab 2011 with a plane), over the bins within 3 NMAD of the median. A shift is damped as if it
/// were known to be a bin's width or less (1 sigma), so that level or noisy ground gives a small one. At
/// least 10 bins. One step tells whether there is a shift; where gradients turn over it, its length needs
/// several, each with the positions of side 1 moved back by the shift, until it changes by less than 0.01
/// bins.
[[nodiscard]] SurfaceDifference surface_difference(const BinnedScans& scans,
                                                   const std::vector<Gradient>& gradients,
                                                   const ReturnSums& sums, int max_steps = 1);

}  // namespace landfall
