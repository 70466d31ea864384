// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D387
#include "hazards/ground_posterior.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/random.h"
#include "hazards/relief_prior.h"
#include "hazards/scale_filter.h"
#include "raster/by_rows.h"
#include "raster/region.h"

namespace landfall {
namespace {

constexpr double kReachM = 4;
constexpr std::int64_t kMaxScales = 6;
constexpr double kFillReachM = 3.2;
/// Bins further from a measured one than interpolation reaches are unknown. They get values from windows so
/// many times as wide, because the filters also reach them from bins that are known.
constexpr std::int64_t kFarther = 4;
constexpr double kDepartureShare = 0.35;
constexpr std::array<float, 2> kSharpening = {1.3F, 1.04F};
constexpr float kOvershootNoise = 0.3F, kOvershootRange = 0.05F, kDepartureNoise = 0.2F;
/// A variance that no float loses: sigma may be 0.
constexpr float kMinVariance = 1e-18F;

std::int64_t scale_count(double resolution_m) {
  std::int64_t count = 1;
  while (count < kMaxScales &&
         static_cast<double>(kLowPassReach * ((std::int64_t{2} << count) - 1)) * resolution_m <= kReachM)
    ++count;
  return count;
}

/// The largest step of the filter that interpolates, which takes the steps 1, 2, 4, ...
std::int64_t fill_step(double resolution_m) {
  std::int64_t step = 1;
  while (static_cast<double>(kBlurReach * (4 * step - 1)) * resolution_m <= kFillReachM) step *= 2;
  return step;
}

/// Interpolates the NaN of a map from the measured bins, each from the narrowest B-spline window that holds
/// one. Returns the bins that have none within kFillReachM; these get values too.
BinMask interpolate(Grid<double>& z, const Grid<float>& seen) {
  const GridSpec& spec = z.spec();
  BinMask unknown(spec);
  std::int64_t missing = 0;
  double sum = 0;
  for (std::size_t i = 0; i < spec.size(); ++i) {
    if (seen.values()[i] > 0) {
      sum += z.values()[i];
    } else {
      ++missing;
      unknown.values()[i] = 1;
    }
  }
  if (missing == 0) return unknown;
  const double mean =
      sum / static_cast<double>(std::max<std::int64_t>(static_cast<std::int64_t>(spec.size()) - missing, 1));
  // About the mean, so that floats hold the relief.
  auto height = Grid<float>::unset(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    height.values()[i] = seen.values()[i] > 0 ? static_cast<float>(z.values()[i] - mean) : 0;
  Grid<float> weight = seen;
  BinMask open = unknown;
  const std::int64_t last = fill_step(spec.resolution_m);
  for (std::int64_t step = 1; step <= kFarther * last; step *= 2) {
    height = blur(height, step);
    weight = blur(weight, step);
    for (std::size_t i = 0; i < spec.size(); ++i) {
      if (open.values()[i] == 0 || weight.values()[i] < 1e-4F) continue;
      z.values()[i] = mean + static_cast<double>(height.values()[i] / weight.values()[i]);
      open.values()[i] = 0;
      if (step <= last) unknown.values()[i] = 0;
    }
  }
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (open.values()[i] != 0) z.values()[i] = mean;
  return unknown;
}

/// The rise per bin from those of both sides: their mean, but at most twice the smaller, and 0 if their signs
/// differ, so that the foot and the rim of a wall are level (van Leer's limiter of monotonized central
/// differences, J. Comput. Phys. 23, 1977).
double limited_rise(double before, double after) {
  if (before * after <= 0) return 0;
  const double mean = (before + after) / 2;
  return std::copysign(std::min(std::abs(mean), 2 * std::min(std::abs(before), std::abs(after))), mean);
}

/// Moves the elevations of measured bins along the slope of the 3 x 3 bins about each.
void move_to_centers(Grid<double>& z, const Grid<float>& seen, const ReturnCentroids& centroids) {
  const GridSpec& spec = z.spec();
  const Grid<double> measured = z;
  by_rows(spec, [&](std::int64_t row) {
    if (row == 0 || row == spec.rows - 1) return;
    const auto column = [&](std::int64_t col) {
      return measured.at({row - 1, col}) + measured.at({row, col}) + measured.at({row + 1, col});
    };
    const auto across = [&](std::int64_t other, std::int64_t col) {
      return measured.at({other, col - 1}) + measured.at({other, col}) + measured.at({other, col + 1});
    };
    for (std::int64_t col = 1; col < spec.cols - 1; ++col) {
      const BinIndex bin{row, col};
      const double x = static_cast<double>(centroids.x.at(bin)) - spec.x(col);
      const double y = static_cast<double>(centroids.y.at(bin)) - spec.y(row);
      if (seen.at(bin) == 0 || std::isnan(x) || std::isnan(y)) continue;
      const double rise_x = limited_rise(column(col) - column(col - 1), column(col + 1) - column(col)) / 3;
      const double rise_y =
          limited_rise(across(row, col) - across(row - 1, col), across(row + 1, col) - across(row, col)) / 3;
      z.at(bin) -= (rise_x * x + rise_y * y) / spec.resolution_m;
    }
  });
}

/// The least and the largest value in the 3 x 3 bins about each bin of a row, clipped at the border.
struct Extremes {
  std::vector<double> low, high;
};

Extremes extremes_of(const Grid<double>& map, std::int64_t row) {
  const GridSpec& spec = map.spec();
  const auto cols = static_cast<std::size_t>(spec.cols);
  Extremes column{std::vector<double>(cols), std::vector<double>(cols)};
  std::ranges::copy(map.row(row), column.low.begin());
  std::ranges::copy(map.row(row), column.high.begin());
  for (const std::int64_t other : {row - 1, row + 1}) {
    if (other < 0 || other >= spec.rows) continue;
    const auto values = map.row(other);
    for (std::size_t c = 0; c < cols; ++c) {
      column.low[c] = std::min(column.low[c], values[c]);
      column.high[c] = std::max(column.high[c], values[c]);
    }
  }
  Extremes result = column;
  for (std::size_t c = 0; c < cols; ++c)
    for (std::size_t near = c == 0 ? 0 : c - 1; near <= std::min(c + 1, cols - 1); ++near) {
      result.low[c] = std::min(result.low[c], column.low[near]);
      result.high[c] = std::max(result.high[c], column.high[near]);
    }
  return result;
}

}  // namespace

GroundPosterior::GroundPosterior(const Grid<double>& z, const SigmaParts& sigma, std::uint64_t seed,
                                 std::optional<ReturnCentroids> centroids)
    : seed_(seed), mean_(z), noise_(z.spec()) {
  const GridSpec& spec = z.spec();
  Grid<float> seen(spec);
  Grid<float> variance(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const float noise = sigma.noise_m.values()[i];
    if (std::isnan(noise) || std::isnan(z.values()[i])) continue;
    seen.values()[i] = 1;
    noise_.values()[i] = noise;
    variance.values()[i] = std::max(noise * noise, kMinVariance);
  }
  const BinMask unknown = interpolate(mean_, seen);
  if (centroids) move_to_centers(mean_, seen, *centroids);
  centroids.reset();  // makes room
  std::vector<Grid<float>> details;
  const Grid<double> filled = mean_;
  while (static_cast<std::int64_t>(details.size()) < scale_count(spec.resolution_m)) {
    Grid<double> smooth = low_pass(mean_, std::int64_t{1} << details.size());
    auto detail = Grid<float>::unset(spec);
    for (std::size_t i = 0; i < spec.size(); ++i)
      detail.values()[i] = static_cast<float>(mean_.values()[i] - smooth.values()[i]);
    details.push_back(std::move(detail));
    mean_ = std::move(smooth);
  }
  add_details(std::move(details), seen, variance, sigma.relief_m);
  set_bounds(filled, sigma);
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (unknown.values()[i] != 0) mean_.values()[i] = std::numeric_limits<double>::quiet_NaN();
}

void GroundPosterior::add_details(std::vector<Grid<float>> details, const Grid<float>& seen,
                                  const Grid<float>& variance, Grid<float> relief_m) {
  const GridSpec& spec = mean_.spec();
  const NoiseGains gains = noise_gains(static_cast<std::int64_t>(details.size()));
  // The noise behind a detail of scale 0 is that of its bin; of scale 1 that of 5 x 5 bins; beyond, of more.
  std::vector<std::pair<Grid<float>, Grid<float>>> behind;
  behind.emplace_back(seen, variance);
  for (const std::int64_t step : {1, 2})
    behind.emplace_back(blur(behind.back().first, step), blur(behind.back().second, step));
  const auto noise_of = [](float share, float sum) {
    return std::max(sum / std::max(share * share, 0.05F), kMinVariance);
  };
  rest_ = Grid<float>::unset(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    rest_.values()[i] =
        std::sqrt(noise_of(behind.back().first.values()[i], behind.back().second.values()[i]));
  spread_.resize(details.size());
  Grid<float> coarser;
  Grid<float> finest(spec);  // relief of the two finest scales
  for (std::size_t j = details.size(); j-- > 0;) {
    const auto& [share, sum] = behind[std::min<std::size_t>(j, behind.size() - 1)];
    const auto power = static_cast<float>(gains.detail[j] * gains.detail[j]);
    auto noise = Grid<float>::unset(spec);
    for (std::size_t i = 0; i < spec.size(); ++i)
      noise.values()[i] = power * noise_of(share.values()[i], sum.values()[i]);
    ScaleRelief found = relief_of({details[j], noise, share, std::int64_t{1} << j},
                                  coarser.spec().size() > 0 ? &coarser : nullptr);
    const float sharp = j < kSharpening.size() ? kSharpening.at(j) : 1;
    for (std::size_t i = 0; i < spec.size(); ++i) {
      mean_.values()[i] += static_cast<double>(sharp * found.gain.values()[i] * details[j].values()[i]);
      float& spread = found.spread_m2.values()[i];
      spread = sharp * std::sqrt(spread / power);
      if (j < 2) finest.values()[i] += found.relief_m2.values()[i];
    }
    spread_[j] = std::move(found.spread_m2);
    details[j] = Grid<float>();
    coarser = std::move(found.relief_m2);
  }
  departure_ = std::move(relief_m);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    float& value = departure_.values()[i];
    value = seen.values()[i] > 0
                ? std::sqrt(std::min(static_cast<float>(kDepartureShare) * value * value, finest.values()[i]))
                : 0;
  }
}

void GroundPosterior::set_bounds(const Grid<double>& z, const SigmaParts& sigma) {
  const GridSpec& spec = z.spec();
  low_ = Grid<float>::unset(spec);
  high_ = Grid<float>::unset(spec);
  by_rows(spec, [&](std::int64_t row) {
    const Extremes around = extremes_of(z, row);
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const auto c = static_cast<std::size_t>(col);
      const BinIndex bin{row, col};
      const float noise = sigma.noise_m.at(bin);
      const bool is_seen = !std::isnan(noise);
      const double mean = mean_.at(bin);
      const double beyond = static_cast<double>(kOvershootNoise * noise) +
                            static_cast<double>(kOvershootRange) * (around.high[c] - around.low[c]);
      constexpr float kNone = std::numeric_limits<float>::infinity();
      low_.at(bin) = is_seen ? static_cast<float>(around.low[c] - beyond - mean) : -kNone;
      high_.at(bin) = is_seen ? static_cast<float>(around.high[c] + beyond - mean) : kNone;
    }
  });
}

Grid<double> GroundPosterior::draw(std::uint64_t number) const {
  const GridSpec& spec = mean_.spec();
  const RandomField field(seed_, RandomStream::map_noise);
  constexpr std::int64_t kOffset = std::int64_t{1} << 31U;  // indices from the origin may be negative
  const auto normals = [&](std::uint64_t kind, std::int64_t row, std::span<double> out) {
    const auto from_origin = static_cast<std::uint64_t>(spec.first_row + row + kOffset);
    field.normals(((2 * number + kind) << 32U) + from_origin,
                  static_cast<std::uint64_t>(spec.first_col + kOffset), out);
  };
  auto noise = Grid<float>::unset(spec);
  by_rows(spec, [&](std::int64_t row) {
    std::vector<double> values(static_cast<std::size_t>(spec.cols));
    normals(0, row, values);
    std::ranges::transform(values, noise.row(row).begin(), [](double v) { return static_cast<float>(v); });
  });
  Grid<double> smooth = mean_;
  for (std::int64_t j = 0; j < scales(); ++j) {
    Grid<float> next = low_pass(noise, std::int64_t{1} << j);
    const Grid<float>& spread = spread_[static_cast<std::size_t>(j)];
    by_rows(spec, [&](std::int64_t row) {
      for (std::size_t c = 0; c < static_cast<std::size_t>(spec.cols); ++c)
        smooth.row(row)[c] +=
            static_cast<double>(spread.row(row)[c] * (noise.row(row)[c] - next.row(row)[c]));
    });
    noise = std::move(next);
  }
  by_rows(spec, [&](std::int64_t row) {
    for (std::size_t c = 0; c < static_cast<std::size_t>(spec.cols); ++c)
      smooth.row(row)[c] += static_cast<double>(rest_.row(row)[c] * noise.row(row)[c]);
  });
  auto ground = Grid<double>::unset(spec);
  by_rows(spec, [&](std::int64_t row) {
    std::vector<double> values(static_cast<std::size_t>(spec.cols));
    normals(1, row, values);
    const Extremes around = extremes_of(smooth, row);
    for (std::size_t c = 0; c < values.size(); ++c) {
      const double mean = mean_.row(row)[c];
      const auto bounded = [&](double value) {
        return std::clamp(value, mean + static_cast<double>(low_.row(row)[c]),
                          mean + static_cast<double>(high_.row(row)[c]));
      };
      const double within = static_cast<double>(kDepartureNoise * noise_.row(row)[c]);
      const double departed =
          bounded(smooth.row(row)[c] + static_cast<double>(departure_.row(row)[c]) * values[c]);
      ground.row(row)[c] = std::isnan(mean) ? mean
                           : noise_.row(row)[c] > 0 || departure_.row(row)[c] > 0
                               ? std::clamp(departed, around.low[c] - within, around.high[c] + within)
                               : departed;
    }
  });
  return ground;
}

std::int64_t GroundPosterior::reach_bins(double resolution_m) {
  const std::int64_t scales = scale_count(resolution_m);
  const std::int64_t coarsest = std::int64_t{1} << (scales - 1);
  const std::int64_t fill_reach = kBlurReach * (2 * fill_step(resolution_m) - 1);
  // Interpolated, moved by a slope, filtered, compared at the coarsest scale, whose relief bounds that of
  // each finer one.
  return fill_reach + kLowPassReach * (2 * coarsest - 1) + relief_reach_bins(coarsest, resolution_m) +
         kBlurReach * coarsest + 3;
}

}  // namespace landfall
