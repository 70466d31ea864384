// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D387, D461
#include "chain/hazards/terrain_posterior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/numerics/random.h"
#include "base/raster/by_rows.h"
#include "base/raster/region.h"
#include "chain/hazards/relief_prior.h"
#include "chain/hazards/scale_filter.h"

namespace landfall {
namespace {

constexpr double kReachM = 4;
constexpr std::int64_t kMaxScales = 6;
constexpr double kFillReachM = 3.2;
/// Bins further from a measured one than interpolation reaches are unknown. They get values from windows so
/// many times as wide, because the filters also reach them from bins that are known.
constexpr std::int64_t kFarther = 4;
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

/// 1 sigma of the relief of the next finer scale than the finest one, whose variances are given with those of
/// the next coarser scale: by the same factor less, and not more. Without a coarser scale (empty), the same.
Grid<float> extrapolated(const Grid<float>& finest_m2, const Grid<float>& coarser_m2) {
  auto sigma = Grid<float>::unset(finest_m2.spec());
  const Grid<float>& before = coarser_m2.spec().size() > 0 ? coarser_m2 : finest_m2;
  for (std::size_t i = 0; i < sigma.spec().size(); ++i) {
    const float finest = finest_m2.values()[i];
    const float factor = finest / std::max(before.values()[i], kMinVariance);
    sigma.values()[i] = std::sqrt(finest * std::min(factor, 1.0F));
  }
  return sigma;
}

/// The differences of a bin from the bins around it that have a value.
struct Differences {
  double curvature = 0;  ///< from the mean of its four neighbours; 0 if one of them has no value
  double like = 0;       ///< size of the second smallest of the eight
};

Differences differences(const Grid<double>& map, BinIndex bin) {
  const GridSpec& spec = map.spec();
  double minimum = std::numeric_limits<double>::infinity();
  Differences result{0, minimum};
  int beside = 0;
  for (std::int64_t row = std::max<std::int64_t>(bin.row - 1, 0); row < std::min(bin.row + 2, spec.rows);
       ++row)
    for (std::int64_t col = std::max<std::int64_t>(bin.col - 1, 0); col < std::min(bin.col + 2, spec.cols);
         ++col) {
      const double off = map.at(bin) - map.at({row, col});
      if ((row == bin.row && col == bin.col) || std::isnan(off)) continue;
      if (row == bin.row || col == bin.col) {
        result.curvature += off / 4;
        ++beside;
      }
      result.like = std::min(result.like, std::max(minimum, std::abs(off)));
      minimum = std::min(minimum, std::abs(off));
    }
  if (beside < 4) result.curvature = 0;
  return result;
}

}  // namespace

TerrainPosterior::TerrainPosterior(const Grid<double>& z, const Grid<float>& noise_m, std::uint64_t seed,
                                   std::optional<ReturnCentroids> centroids)
    : seed_(seed), mean_(z) {
  const GridSpec& spec = z.spec();
  Grid<float> seen(spec);
  Grid<float> variance(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const float noise = noise_m.values()[i];
    if (std::isnan(noise) || std::isnan(z.values()[i])) continue;
    seen.values()[i] = 1;
    variance.values()[i] = std::max(noise * noise, kMinVariance);
  }
  const BinMask unknown = interpolate(mean_, seen);
  if (centroids) move_to_centers(mean_, seen, *centroids);
  centroids.reset();  // makes room
  std::vector<Grid<float>> details;
  while (static_cast<std::int64_t>(details.size()) < scale_count(spec.resolution_m)) {
    Grid<double> smooth = low_pass(mean_, std::int64_t{1} << details.size());
    auto detail = Grid<float>::unset(spec);
    for (std::size_t i = 0; i < spec.size(); ++i)
      detail.values()[i] = static_cast<float>(mean_.values()[i] - smooth.values()[i]);
    details.push_back(std::move(detail));
    mean_ = std::move(smooth);
  }
  add_details(std::move(details), seen, variance);
  for (std::size_t i = 0; i < spec.size(); ++i)
    if (unknown.values()[i] != 0) mean_.values()[i] = std::numeric_limits<double>::quiet_NaN();
}

void TerrainPosterior::add_details(std::vector<Grid<float>> details, const Grid<float>& seen,
                                   const Grid<float>& variance) {
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
  for (std::size_t j = details.size(); j-- > 0;) {
    const auto& [share, sum] = behind[std::min<std::size_t>(j, behind.size() - 1)];
    const auto power = static_cast<float>(gains.detail[j] * gains.detail[j]);
    auto noise = Grid<float>::unset(spec);
    for (std::size_t i = 0; i < spec.size(); ++i)
      noise.values()[i] = power * noise_of(share.values()[i], sum.values()[i]);
    ScaleRelief found = relief_of({details[j], noise, share, std::int64_t{1} << j},
                                  coarser.spec().size() > 0 ? &coarser : nullptr);
    for (std::size_t i = 0; i < spec.size(); ++i) {
      mean_.values()[i] += static_cast<double>(found.gain.values()[i] * details[j].values()[i]);
      float& spread = found.spread_m2.values()[i];
      spread = std::sqrt(spread / power);
    }
    if (j == 0) departure_ = extrapolated(found.relief_m2, coarser);
    spread_[j] = std::move(found.spread_m2);
    details[j] = Grid<float>();
    coarser = std::move(found.relief_m2);
  }
}

Grid<double> TerrainPosterior::draw(std::uint64_t number) const {
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
  auto terrain = Grid<double>::unset(spec);
  by_rows(spec, [&](std::int64_t row) {
    std::vector<double> values(static_cast<std::size_t>(spec.cols));
    normals(1, row, values);
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const Differences off = differences(smooth, {row, col});
      const double departure = std::min(static_cast<double>(departure_.at({row, col})), off.like);
      terrain.at({row, col}) =
          smooth.at({row, col}) + off.curvature / 6 + departure * values[static_cast<std::size_t>(col)];
    }
  });
  return terrain;
}

std::int64_t TerrainPosterior::reach_bins(double resolution_m) {
  const std::int64_t scales = scale_count(resolution_m);
  const std::int64_t coarsest = std::int64_t{1} << (scales - 1);
  const std::int64_t fill_reach = kBlurReach * (2 * fill_step(resolution_m) - 1);
  // Interpolated, moved by a slope, filtered, compared at the coarsest scale, whose relief bounds that of
  // each finer one, and made points of bins.
  return fill_reach + kLowPassReach * (2 * coarsest - 1) + relief_reach_bins(coarsest, resolution_m) +
         kBlurReach * coarsest + 2;
}

}  // namespace landfall
