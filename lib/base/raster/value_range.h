// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>

namespace landfall {

/// The least and the greatest of the values added; NaN is ignored. The result does not depend on the order of
/// the values: a zero has no sign.
class ValueRange {
 public:
  template <class T>
  void add(std::span<const T> values) {
    constexpr std::size_t kLanes = 8;  // independent comparisons, which compilers vectorise
    std::array<double, kLanes> low;
    std::array<double, kLanes> high;
    low.fill(low_);
    high.fill(high_);
    std::size_t i = 0;
    for (; i + kLanes <= values.size(); i += kLanes)
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const auto value = static_cast<double>(values[i + lane]);
        low[lane] = value < low[lane] ? value : low[lane];
        high[lane] = value > high[lane] ? value : high[lane];
      }
    for (; i < values.size(); ++i) {
      const auto value = static_cast<double>(values[i]);
      low[0] = value < low[0] ? value : low[0];
      high[0] = value > high[0] ? value : high[0];
    }
    low_ = *std::min_element(low.begin(), low.end());
    high_ = *std::max_element(high.begin(), high.end());
  }
  void add(const ValueRange& other) {
    low_ = std::min(low_, other.low_);
    high_ = std::max(high_, other.high_);
  }

  /// The least and the greatest value; nothing if there is none.
  [[nodiscard]] std::optional<std::array<double, 2>> pair() const {
    if (low_ > high_) return std::nullopt;
    return std::array{low_ + 0.0, high_ + 0.0};  // -0 + 0 is +0
  }

 private:
  double low_ = std::numeric_limits<double>::infinity();
  double high_ = -std::numeric_limits<double>::infinity();
};

}  // namespace landfall
