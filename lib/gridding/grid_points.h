// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace landfall {

/// One batch of returns, column by column, all of one length. Metres in frame D; t in seconds. `_est` is
/// where the lander believes the return lies (Eq. 7), `_true` where it lies.
struct GridPoints {
  std::span<const double> x_est;
  std::span<const double> y_est;
  std::span<const double> z_est;
  std::span<const double> x_true;
  std::span<const double> y_true;
  std::span<const double> z_true;
  std::span<const double> t;

  [[nodiscard]] std::size_t size() const { return x_est.size(); }
  /// `count` points from `first` on.
  [[nodiscard]] GridPoints subset(std::size_t first, std::size_t count) const {
    return {.x_est = x_est.subspan(first, count),
            .y_est = y_est.subspan(first, count),
            .z_est = z_est.subspan(first, count),
            .x_true = x_true.subspan(first, count),
            .y_true = y_true.subspan(first, count),
            .z_true = z_true.subspan(first, count),
            .t = t.subspan(first, count)};
  }
};

}  // namespace landfall
