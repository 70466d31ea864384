// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "base/error.h"
#include "gridding/grid_points.h"
#include "raster/grid_spec.h"

namespace landfall {

/// What a method makes of the returns of one bin. Metres in frame D, seconds. In an empty bin everything but
/// the count is NaN.
struct BinValues {
  std::int32_t count;  ///< returns that took part
  double weight_sum;   ///< of the returns; the count where the method knows no weights
  double z_est;
  double x_true;  ///< where the returns that z_est comes from truly lie
  double y_true;
  double x_est;  ///< where they are believed to lie
  double y_est;
  double x_offset;  ///< x_true - x_est, rounded once
  double y_offset;
  double t;
  double z_spread;  ///< standard deviation of z_est over the bin's returns, divided by the sum of weights
};

[[nodiscard]] BinValues empty_bin();

/// A method of making a map of returns: it takes them batch by batch, in order, and tells the values of every
/// bin. Each bin sees its returns in the order they came in, so that values depend on neither threads nor
/// batches.
class Accumulator {
 public:
  /// Throws UsageError unless the resolution is finite and positive and rows and columns are at least 1.
  explicit Accumulator(const GridSpec& spec);
  virtual ~Accumulator() = default;
  Accumulator(const Accumulator&) = delete;
  Accumulator& operator=(const Accumulator&) = delete;

  /// Adds returns; those that reach no bin are counted, not an error.
  virtual void add(const GridPoints& points) = 0;

  /// To be called after all returns. True where the method must see all of them once more, in the same order.
  virtual bool end_pass() { return false; }
  /// How far a method of several passes is, from the share of the present pass: in [0, 1], never decreasing.
  [[nodiscard]] virtual double progress(double pass_fraction) const { return pass_fraction; }

  /// The bins from `first` on along its row, as many as `out` holds; they must lie in the grid. Valid after
  /// the last pass.
  virtual void values(BinIndex first, std::span<BinValues> out) const = 0;

  static constexpr std::int64_t kMaxReturns = std::numeric_limits<std::int32_t>::max();

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// Returns that reached a bin, and returns that reached none.
  [[nodiscard]] std::int64_t inside_count() const { return inside_count_; }
  [[nodiscard]] std::int64_t outside_count() const { return outside_count_; }

 protected:
  Accumulator(Accumulator&&) = default;
  /// Throws FormatError where a bin's count, an int32, may have gone past its end.
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
