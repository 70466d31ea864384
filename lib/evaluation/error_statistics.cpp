// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/error_statistics.h"

#include <cmath>
#include <limits>

#include "evaluation/order_statistics.h"
#include "evaluation/piecewise.h"

namespace landfall {
namespace {

/// The standard deviation of a normal distribution over its median absolute deviation.
constexpr double kNormalPerDeviation = 1.4826;

/// What `of` makes of the region's errors; NaN elsewhere.
template <class Of>
auto in_region(const Grid<double>& error, const BinMask& region, const Of& of) {
  return [errors = error.values(), mask = region.values(), of](std::size_t i) {
    return mask[i] != 0 ? of(errors[i]) : std::numeric_limits<double>::quiet_NaN();
  };
}

constexpr auto kItself = [](double e) { return e; };
constexpr auto kSquare = [](double e) { return e * e; };
constexpr auto kMagnitude = [](double e) { return std::abs(e); };

}  // namespace

ErrorStatistics error_statistics(const Grid<double>& error, const BinMask& region) {
  const std::size_t bins = region.spec().size();
  const CountedSum sum = counted_sum(bins, in_region(error, region, kItself));
  ErrorStatistics result{.count = sum.count};
  if (sum.count == 0) return result;
  const double mean = sum.mean();
  const auto squared = [=](double e) { return (e - mean) * (e - mean); };
  const double std = std::sqrt(counted_sum(bins, in_region(error, region, squared)).mean());
  const double median = *quantile_of(bins, in_region(error, region, kItself), 0.5);
  const auto deviation = [=](double e) { return std::abs(e - median); };
  const Quantiles magnitudes(bins, in_region(error, region, kMagnitude));
  result.mean_m = mean;
  result.std_m = std;
  result.rmse_m = std::hypot(mean, std);
  result.median_m = median;
  result.nmad_m = kNormalPerDeviation * *quantile_of(bins, in_region(error, region, deviation), 0.5);
  result.le90_m = magnitudes.at(0.9);
  result.p95_m = magnitudes.at(0.95);
  return result;
}

HorizontalStatistics horizontal_statistics(const Grid<double>& horizontal, const BinMask& region) {
  const std::size_t bins = region.spec().size();
  const CountedSum squares = counted_sum(bins, in_region(horizontal, region, kSquare));
  if (squares.count == 0) return {.count = 0};
  return {.count = squares.count,
          .ce90_m = quantile_of(bins, in_region(horizontal, region, kItself), 0.9),
          .rmse_m = std::sqrt(squares.mean())};
}

}  // namespace landfall
