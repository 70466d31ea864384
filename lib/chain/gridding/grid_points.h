// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "base/returns/columns.h"

namespace landfall {

/// One batch of returns, column by column, all of the same length. Metres in frame D; t in seconds. `_est` is
/// the estimated position of the return (Eq. 7), `_true` where it really lies. All values of a return are
/// finite: the code that reads returns from files checks that (ScanReader), gridding does not. A point
/// without an estimate has a NaN position: it is not a return, and falls in no bin.
struct GridPoints {
  using Columns = std::array<std::span<const double>, 7>;

  std::span<const double> x_est;
  std::span<const double> y_est;
  std::span<const double> z_est;
  std::span<const double> x_true;
  std::span<const double> y_true;
  std::span<const double> z_true;
  std::span<const double> t;

  /// `t` is the time of each point's pulse.
  static GridPoints of(const PointColumns& p, std::span<const double> t) {
    return {p.x_est, p.y_est, p.z_est, p.x_true, p.y_true, p.z_true, t};
  }
  static GridPoints of(const Columns& c) { return {c[0], c[1], c[2], c[3], c[4], c[5], c[6]}; }
  [[nodiscard]] Columns columns() const { return {x_est, y_est, z_est, x_true, y_true, z_true, t}; }

  [[nodiscard]] std::size_t size() const { return x_est.size(); }
  /// `count` points from `first` on.
  [[nodiscard]] GridPoints subset(std::size_t first, std::size_t count) const {
    Columns part = columns();
    for (std::span<const double>& column : part) column = column.subspan(first, count);
    return of(part);
  }
};

}  // namespace landfall
