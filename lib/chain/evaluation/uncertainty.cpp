// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D65
#include "chain/evaluation/uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "base/core/error.h"
#include "base/raster/window_mean.h"
#include "chain/evaluation/piecewise.h"

namespace landfall {
namespace {

constexpr std::size_t kShares = 16;
constexpr double kShareStep = 0.25;  // sigma

struct Scores {
  std::int64_t count = 0;
  double sum = 0;
  double sum_of_squares = 0;
  std::int64_t within_1 = 0;
  std::int64_t within_2 = 0;

  void add(double score) {
    ++count;
    sum += score;
    sum_of_squares += score * score;
    within_1 += std::abs(score) <= 1 ? 1 : 0;
    within_2 += std::abs(score) <= 2 ? 1 : 0;
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
  [[nodiscard]] double std() const {
    return std::sqrt(std::max(0.0, sum_of_squares / static_cast<double>(count) - mean() * mean()));
  }
  [[nodiscard]] double frac(std::int64_t within) const {
    return static_cast<double>(within) / static_cast<double>(count);
  }
};

/// The errors whose sigma lies in one step; each octave of sigma has four steps.
struct SigmaStep {
  std::int64_t count = 0;
  double sum_of_variances = 0;
  double sum_of_squares = 0;

  /// The computation is exact, so that a sigma falls on the same side of a border on every machine: borders
  /// are rounded powers of two with the exponents 0, 1/4, 1/2 and 3/4.
  static int of(double sigma) {
    constexpr std::array kBorders{0.5946035575013605, 0.7071067811865476, 0.8408964152537145};
    int exponent = 0;
    const double fraction = std::frexp(sigma, &exponent);  // in [1/2, 1)
    return 4 * exponent + static_cast<int>(std::ranges::count_if(
                              kBorders, [&](double border) { return fraction >= border; }));
  }
};

/// Accumulates errors one by one.
class Assessment {
 public:
  void add(double error, double sigma, std::int32_t count) {
    if (std::isnan(error)) return;
    if (!(sigma > 0) || std::isinf(sigma)) {
      ++left_out_;
      return;
    }
    const double score = error / sigma;
    all_.add(score);
    by_count_[count].add(score);
    SigmaStep& step = steps_[SigmaStep::of(sigma)];
    ++step.count;
    step.sum_of_variances += sigma * sigma;
    step.sum_of_squares += error * error;
    const double nearest_step = std::ceil(std::abs(score) / kShareStep);
    if (nearest_step <= static_cast<double>(kShares))
      ++shares_[std::max(static_cast<std::size_t>(nearest_step), std::size_t{1}) - 1];
  }

  [[nodiscard]] ScoreMetrics metrics(bool counts_known) const {
    ScoreMetrics result{.count = all_.count, .left_out_count = left_out_};
    if (all_.count == 0) return result;
    result.mean = all_.mean();
    result.std = all_.std();
    result.within_1_sigma_frac = all_.frac(all_.within_1);
    result.within_2_sigma_frac = all_.frac(all_.within_2);
    if (counts_known) {
      for (const auto& [count, scores] : by_count_) {
        result.by_count.count.push_back(count);
        result.by_count.bins.push_back(scores.count);
        result.by_count.std.push_back(scores.std());
        result.by_count.within_1_sigma_frac.push_back(scores.frac(scores.within_1));
        result.by_count.within_2_sigma_frac.push_back(scores.frac(scores.within_2));
      }
    }
    for (const auto& [unused, step] : steps_) {
      const auto n = static_cast<double>(step.count);
      result.reliability.sigma_m.push_back(std::sqrt(step.sum_of_variances / n));
      result.reliability.rmse_m.push_back(std::sqrt(step.sum_of_squares / n));
      result.reliability.bins.push_back(step.count);
    }
    std::int64_t within = 0;
    for (std::size_t i = 0; i < kShares; ++i) {
      result.within_k_sigma.k.push_back(kShareStep * static_cast<double>(i + 1));
      result.within_k_sigma.frac.push_back(all_.frac(within += shares_[i]));
    }
    return result;
  }

 private:
  Scores all_;
  std::int64_t left_out_ = 0;
  std::map<std::int32_t, Scores> by_count_;
  std::map<int, SigmaStep> steps_;
  std::array<std::int64_t, kShares> shares_{};  ///< scores in (k - step, k]
};

ScoreMetrics assess(const Grid<double>& error, const Grid<float>& sigma, const UncertaintyLayers& layers,
                    const BinMask& region) {
  Assessment assessment;
  for (std::size_t i = 0; i < region.values().size(); ++i)
    if (region.values()[i] != 0)
      assessment.add(error.values()[i], static_cast<double>(sigma.values()[i]),
                     layers.count ? layers.count->values()[i] : 0);
  return assessment.metrics(layers.count.has_value());
}

Grid<double> deviation_from_mean(const Grid<double>& error, const Footprint& footprint) {
  WindowMeans windows = window_means(error, footprint);
  for_each_index(error.values().size(), [&](std::size_t i) {
    double& value = windows.mean.values()[i];
    value =
        windows.count.values()[i] > 1 ? error.values()[i] - value : std::numeric_limits<double>::quiet_NaN();
  });
  return std::move(windows.mean);
}

}  // namespace

UncertaintyMetrics assess_uncertainty(const UncertaintyLayers& layers, const BinMask& region,
                                      const Footprint& footprint) {
  const GridSpec& spec = region.spec();
  if (layers.error.spec() != spec || layers.sigma_abs.spec() != spec || layers.sigma_rel.spec() != spec ||
      (layers.count && layers.count->spec() != spec))
    throw FormatError("the layers of the 1-sigma map and count: their grid differs from that of z_est");
  return {.absolute = assess(layers.error, layers.sigma_abs, layers, region),
          .relative = assess(deviation_from_mean(layers.error, footprint), layers.sigma_rel, layers, region)};
}

}  // namespace landfall
