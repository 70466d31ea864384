// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D374
#include "formats/gdal/fill_values.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/core/error.h"
#include "base/raster/fill_search.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

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

[[noreturn]] void refuse(const std::vector<Fill>& fills, const FillSearch::Result& found,
                         const DemBase& dem) {
  const std::string others = found.rest.empty() ? "no other sample has a value"
                                                : "the others lie in " + short_number(found.rest.low) +
                                                      " .. " + short_number(found.rest.high) + " m";
  throw FormatError(dem.path + ": " + std::to_string(count_of(fills)) + " of " + std::to_string(found.total) +
                        " samples are " + suspicion_text(fills) + " (" + others + "); give nodata " +
                        nodata_text(fills) + " to make them holes, or nodata none to keep them",
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
  FillSearch::Range rest;
  std::int64_t zeros = 0;
  double nearest = std::numeric_limits<double>::infinity();
  for (const double value : samples.values) {
    if (std::isnan(value)) continue;
    if (value == zero) {
      ++zeros;
      continue;
    }
    rest = {std::min(rest.low, value), std::max(rest.high, value)};
    nearest = std::min(nearest, std::abs(value - zero));
  }
  if (rest.empty() || nearest <= 0.1 * (rest.high - rest.low)) return std::nullopt;
  return std::to_string(zeros) +
         " samples of 0 fill the border, far from all others: 0 as an elevation is assumed (nodata 0 makes "
         "them "
         "holes)";
}

}  // namespace

std::optional<std::string> check_fill_values(const DemSamples& samples, const PixelBox& needed,
                                             const Scaling& elevation, bool is_integer, const DemBase& dem) {
  if (dem.keeps_undeclared_fills) return std::nullopt;
  FillSearch search({elevation.scale, elevation.offset, is_integer});
  search.add(samples.values);
  FillSearch::Result found = search.result();
  std::erase_if(found.fills, [&](const Fill& fill) { return !lies_in(samples, needed, fill.value); });
  if (!found.fills.empty()) refuse(found.fills, found, dem);
  return zero_fill(samples, elevation);
}

}  // namespace landfall
