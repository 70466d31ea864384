// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "base/core/error.h"
#include "base/raster/grid_spec.h"
#include "chain/gridding/grid_points.h"

namespace landfall {

/// The values that a method computes from the returns of one bin. Metres in frame D, seconds. In an empty bin
/// everything except the count is NaN.
struct BinValues {
  std::int32_t count;  ///< returns that were used
  double weight_sum;   ///< sum of the weights; the count for a method without weights
  double z_est;
  double x_true;  ///< true position of the returns that z_est comes from
  double y_true;
  double x_est;  ///< their estimated position
  double y_est;
  double x_offset;  ///< x_true - x_est, rounded once
  double y_offset;
  double t;
  double spread;  ///< standard deviation of z_est over the bin's returns, divided by the sum of weights
};

[[nodiscard]] BinValues empty_bin();

/// A gridding method: it takes returns batch by batch, in order, and gives the values of every bin. Each bin
/// sees its returns in the order of arrival, so that values depend neither on the number of threads nor on
/// the batches.
class Accumulator {
 public:
  /// Throws UsageError unless the resolution is finite and positive and rows and columns are at least 1.
  explicit Accumulator(const GridSpec& spec);
  virtual ~Accumulator() = default;
  Accumulator(const Accumulator&) = delete;
  Accumulator& operator=(const Accumulator&) = delete;

  /// Adds returns. Those that reach no bin are counted; they are not an error.
  virtual void add(const GridPoints& points) = 0;

  /// To be called after all returns. True if the method must see all of them again, in the same order.
  virtual bool end_pass() { return false; }
  /// Overall progress of a multi-pass method, from that of the present pass: in [0, 1], never decreasing.
  [[nodiscard]] virtual double progress(double pass_fraction) const { return pass_fraction; }

  /// The values of the bins from `first` along its row, as many as `out` holds; they must lie in the grid.
  /// Valid after the last pass.
  virtual void values(BinIndex first, std::span<BinValues> out) const = 0;

  /// values(); if forgets(), the bins are empty after it, for which they are in the cache now. Once all are
  /// taken and restart() is called, the memory can be used for another DEM.
  virtual void take_values(BinIndex first, std::span<BinValues> out) { values(first, out); }
  [[nodiscard]] virtual bool forgets() const { return false; }
  void restart() { inside_count_ = outside_count_ = 0; }

  static constexpr std::int64_t kMaxReturns = std::numeric_limits<std::int32_t>::max();

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// Number of returns that reached a bin, and of those that did not.
  [[nodiscard]] std::int64_t inside_count() const { return inside_count_; }
  [[nodiscard]] std::int64_t outside_count() const { return outside_count_; }

 protected:
  Accumulator(Accumulator&&) = default;
  /// Throws FormatError where the count of a bin, an int32, may have overflowed.
  void count_points(std::size_t all, std::size_t outside) {
    inside_count_ += static_cast<std::int64_t>(all - outside);
    outside_count_ += static_cast<std::int64_t>(outside);
    if (inside_count_ > kMaxReturns)
      throw FormatError("more than " + std::to_string(kMaxReturns) +
                        " returns lie in the grid, the most that one DEM can count; give fewer scans");
  }

 private:
  GridSpec spec_;
  std::int64_t inside_count_ = 0;
  std::int64_t outside_count_ = 0;
};

}  // namespace landfall
