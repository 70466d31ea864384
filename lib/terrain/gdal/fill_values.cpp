// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D374
#include "terrain/gdal/fill_values.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/error.h"
#include "base/number_text.h"

namespace landfall {
namespace {

/// Raw numbers that stand for "no data" in files of many producers.
constexpr std::array kFills = {-32768.0,      -32767.0,      32767.0,      65535.0,  -9999.0,
                               9999.0,        -99999.0,      99999.0,      -999.0,   1e6,
                               -2147483648.0, -2147483647.0, 2147483647.0, -999999.0};
constexpr double kAbsurd = 1e12;  ///< no elevation; -3.4e38 and the default fills of netCDF lie beyond

struct Fill {
  double raw;
  double value;  ///< after scaling
  std::int64_t count = 0;
};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  [[nodiscard]] bool empty() const { return low > high; }
  [[nodiscard]] double relief() const { return high - low; }
  /// The distance of a value outside the range; negative inside.
  [[nodiscard]] double distance(double value) const { return std::max(low - value, value - high); }
};

/// A value after scaling whose raw number is beyond any elevation.
bool is_absurd(double value, const Scaling& elevation) {
  return std::abs(value - elevation.offset) >= kAbsurd * std::abs(elevation.scale);
}

/// Samples, sorted into fills and the rest.
class Sorted {
 public:
  Sorted(const DemSamples& samples, const Scaling& elevation) : elevation_(elevation) {
    for (const double raw : kFills) fills_.push_back({raw, elevation.scale * raw + elevation.offset});
    for (const double value : samples.values)
      if (!std::isnan(value)) add(value);
  }
  [[nodiscard]] const std::vector<Fill>& fills() const { return fills_; }
  [[nodiscard]] const Range& rest() const { return rest_; }
  [[nodiscard]] std::int64_t total() const { return total_; }

 private:
  void add(double value) {
    ++total_;
    const auto known = std::ranges::find(fills_, value, &Fill::value);
    if (known != fills_.end()) {
      ++known->count;
    } else if (is_absurd(value, elevation_)) {
      fills_.push_back({(value - elevation_.offset) / elevation_.scale, value, 1});
    } else {
      rest_.add(value);
    }
  }

  Scaling elevation_;
  std::vector<Fill> fills_;
  Range rest_;
  std::int64_t total_ = 0;
};

/// The lowest and the highest sample: only if one of them may be a fill are all samples sorted.
bool may_hold_fills(const DemSamples& samples, const Scaling& elevation) {
  Range range;
  for (const double value : samples.values)
    if (!std::isnan(value)) range.add(value);
  if (range.empty()) return false;
  const auto is_end = [&](double raw) {
    const double value = elevation.scale * raw + elevation.offset;
    return value == range.low || value == range.high;
  };
  return is_absurd(range.low, elevation) || is_absurd(range.high, elevation) ||
         std::ranges::any_of(kFills, is_end);
}

bool is_isolated(const Fill& fill, const Sorted& sorted, const Scaling& elevation, bool is_integer) {
  if (fill.count == 0) return false;
  if (sorted.rest().empty() || is_absurd(fill.value, elevation)) return true;
  const double distance = sorted.rest().distance(fill.value);
  if (is_integer && distance <= 2 * std::abs(elevation.scale)) return false;  // a step of the numbers
  const double relief = sorted.rest().relief();
  return distance > 0.1 * relief || (distance > 0.001 * relief && 100 * fill.count > sorted.total());
}

bool lies_in(const DemSamples& samples, const PixelBox& box, double value) {
  constexpr double kReach = 2;  // of bicubic interpolation
  const auto first = [](double low) {
    return std::max<std::int64_t>(0, static_cast<std::int64_t>(low - kReach));
  };
  const auto last = [](double high, std::int64_t count) {
    return std::min(count - 1, static_cast<std::int64_t>(high + kReach));
  };
  for (std::int64_t row = first(box.low.row); row <= last(box.high.row, samples.size.rows); ++row)
    for (std::int64_t col = first(box.low.col); col <= last(box.high.col, samples.size.cols); ++col)
      if (samples.at(row, col) == value) return true;
  return false;
}

[[noreturn]] void refuse(const Fill& fill, const Sorted& sorted, const DemBase& dem) {
  const std::string number = number_text(fill.raw);
  const std::string others = sorted.rest().empty() ? "no other sample has a value"
                                                   : "the others lie in " + short_number(sorted.rest().low) +
                                                         " .. " + short_number(sorted.rest().high) + " m";
  throw FormatError(dem.path + ": " + std::to_string(fill.count) + " of " + std::to_string(sorted.total()) +
                        " samples are " + number + ", which looks like an undeclared fill value (" + others +
                        "); give nodata " + number + " to make them holes, or nodata none to keep them",
                    "nodata");
}

/// Zeros on the four sides of the raster.
class ZeroBorder {
 public:
  ZeroBorder(const DemSamples& samples, double zero) : samples_(samples), zero_(zero) {
    const auto [rows, cols] = samples.size;
    for (const std::int64_t row : {std::int64_t{0}, rows - 1})
      side(cols, [&](std::int64_t col) { return samples_.at(row, col); });
    for (const std::int64_t col : {std::int64_t{0}, cols - 1})
      side(rows, [&](std::int64_t row) { return samples_.at(row, col); });
  }
  [[nodiscard]] bool filled() const { return any_side_ || 2 * zeros_ >= count_; }

 private:
  template <class Value>
  void side(std::int64_t length, const Value& value) {
    std::int64_t zeros = 0;
    for (std::int64_t i = 0; i < length; ++i) zeros += value(i) == zero_ ? 1 : 0;
    any_side_ = any_side_ || zeros == length;
    zeros_ += zeros;
    count_ += length;
  }

  const DemSamples& samples_;
  double zero_;
  bool any_side_ = false;
  std::int64_t zeros_ = 0;
  std::int64_t count_ = 0;
};

std::optional<std::string> zero_fill(const DemSamples& samples, const Scaling& elevation) {
  const double zero = elevation.offset;
  if (!ZeroBorder(samples, zero).filled()) return std::nullopt;
  Range rest;
  std::int64_t zeros = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const double value : samples.values) {
    if (std::isnan(value)) continue;
    if (value == zero) {
      ++zeros;
      continue;
    }
    rest.add(value);
    nearest = std::min(nearest, std::abs(value - zero));
  }
  if (rest.empty() || nearest <= 0.1 * rest.relief()) return std::nullopt;
  return std::to_string(zeros) +
         " samples of 0 fill the border, far from all others: 0 as an elevation is assumed (nodata 0 makes "
         "them "
         "holes)";
}

}  // namespace

std::optional<std::string> check_fill_values(const DemSamples& samples, const PixelBox& needed,
                                             const Scaling& elevation, bool is_integer, const DemBase& dem) {
  if (dem.keeps_undeclared_fills) return std::nullopt;
  if (may_hold_fills(samples, elevation)) {
    const Sorted sorted(samples, elevation);
    for (const Fill& fill : sorted.fills())
      if (is_isolated(fill, sorted, elevation, is_integer) && lies_in(samples, needed, fill.value))
        refuse(fill, sorted, dem);
  }
  return zero_fill(samples, elevation);
}

}  // namespace landfall
