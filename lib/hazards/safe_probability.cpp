// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/safe_probability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "hazards/denoise.h"
#include "raster/window_mean.h"

namespace landfall {
namespace {

constexpr std::size_t kRedrawnRows = 16;
constexpr double kCertain = 8;  // sigma
constexpr std::size_t kReplicates = 3;
constexpr std::int64_t kSampledRows = 8;
/// Of the variance of relief, the part by which the ground at the centre of a bin differs from its mean. The
/// rest is that of the mean of a few returns, which denoise() averages, and a margin of regrid at smooth
/// bends.
constexpr double kGroundShare = 1.0 / 3;
constexpr std::uint64_t kSeed = 1;

template <class Work>
void by_rows(std::int64_t rows, const Work& work) {
  parallel_for(static_cast<std::size_t>(rows), kRedrawnRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) work(static_cast<std::int64_t>(row));
  });
}

/// The map with noise of its bins' sigma.
Grid<double> redrawn(const Grid<double>& z, const Grid<double>& sigma, std::size_t replicate) {
  const GridSpec& spec = z.spec();
  const RandomField noise(kSeed, RandomStream::map_noise);
  Grid<double> result = z;
  by_rows(spec.rows, [&](std::int64_t row) {
    std::vector<double> draws(static_cast<std::size_t>(spec.cols));
    noise.normals(replicate, static_cast<std::uint64_t>(row * spec.cols), draws);
    for (std::size_t c = 0; c < draws.size(); ++c) result.row(row)[c] += sigma.row(row)[c] * draws[c];
  });
  return result;
}

/// Each value becomes the mean over the places in the window about it that have one (not NaN); where there is
/// none, the mean over all.
void average(Grid<float>& map, const Footprint& window) {
  Grid<double> values(map.spec());
  double sum = 0;
  std::int64_t count = 0;
  for (std::size_t i = 0; i < map.spec().size(); ++i) {
    const double value = map.values()[i];
    values.values()[i] = value;
    if (std::isnan(value)) continue;
    sum += value;
    ++count;
  }
  const double all = count > 0 ? sum / static_cast<double>(count) : 0;
  values = window_means(values, window).mean;
  for (std::size_t i = 0; i < map.spec().size(); ++i) {
    const double value = values.values()[i];
    map.values()[i] = static_cast<float>(std::isnan(value) ? all : value);
  }
}

/// The mean error of a measure in the replicates.
class ErrorMean {
 public:
  explicit ErrorMean(const GridSpec& spec) : mean_(spec) {}

  /// Call kReplicates times, then over().
  void add(const Grid<float>& truth, const Grid<double>& measured) {
    for (std::size_t i = 0; i < truth.spec().size(); ++i) {
      const double error = measured.values()[i] - static_cast<double>(truth.values()[i]);
      mean_.values()[i] += static_cast<float>(error / kReplicates);
    }
  }
  [[nodiscard]] Grid<float> over(const Footprint& window) && {
    average(mean_, window);
    return std::move(mean_);
  }

 private:
  Grid<float> mean_;
};

/// The variance of the errors of a measure in the replicates.
class ErrorVariance {
 public:
  explicit ErrorVariance(const GridSpec& spec) : mean_(spec), mean_square_(spec) {}

  /// As ErrorMean.
  void add(const Grid<float>& truth, const Grid<double>& measured) {
    mean_.add(truth, measured);
    for (std::size_t i = 0; i < truth.spec().size(); ++i) {
      const double error = measured.values()[i] - static_cast<double>(truth.values()[i]);
      mean_square_.values()[i] += static_cast<float>(error * error / kReplicates);
    }
  }
  [[nodiscard]] Grid<float> over(const Footprint& window) && {
    const Grid<float> mean = std::move(mean_).over(window);
    average(mean_square_, window);
    for (std::size_t i = 0; i < mean.spec().size(); ++i) {
      const double square = static_cast<double>(mean.values()[i]) * static_cast<double>(mean.values()[i]);
      float& value = mean_square_.values()[i];
      value = static_cast<float>(static_cast<double>(value) - square);
    }
    return std::move(mean_square_);
  }

 private:
  ErrorMean mean_;
  Grid<float> mean_square_;
};

/// Phi(room / std).
double probability(double room, double variance) {
  if (!(variance > 0)) return room >= 0 ? 1 : 0;
  return 0.5 * std::erfc(-room / std::sqrt(2 * variance));
}

/// The mean variance of the bins in the window about each.
Grid<double> mean_variance(const Grid<double>& sigma, const Footprint& window) {
  Grid<double> variance = sigma;
  for (double& value : variance.values()) value *= value;
  return window_means(variance, window).mean;
}

/// Places of every kSampledRows-th row that are near an open place: what is averaged over a window need not
/// be measured everywhere. A small window holds all.
BinMask sampled(const BinMask& open, const Footprint& window) {
  if (window.half_bins() < kSampledRows / 2) return open;
  const GridSpec& spec = open.spec();
  BinMask places(spec);
  by_rows(spec.rows, [&](std::int64_t row) {
    if (row % kSampledRows != 0) return;
    const std::int64_t first = std::max<std::int64_t>(row - kSampledRows / 2, 0);
    const std::int64_t last = std::min(row + kSampledRows / 2, spec.rows - 1);
    for (std::int64_t near = first; near <= last; ++near)
      for (std::int64_t col = 0; col < spec.cols; ++col) places.at({row, col}) |= open.at({near, col});
  });
  return places;
}

/// P where it is certain, and the places where it is not.
struct Sorted {
  Grid<float> p;
  BinMask open;
};

Sorted sort_places(const PlaceMeasures& measured, const Grid<double>& z_sigma, const Footprint& window,
                   const HazardLimits& limits, double slope_base_m) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const GridSpec& spec = z_sigma.spec();
  const Grid<double> variance = mean_variance(z_sigma, window);
  Sorted sorted{Grid<float>(spec, std::numeric_limits<float>::quiet_NaN()), BinMask(spec)};
  by_rows(spec.rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex place{row, col};
      const double roughness_m = measured.roughness_m.at(place);
      if (std::isnan(roughness_m)) continue;
      const double sigma = kCertain * std::sqrt(variance.at(place));
      const double rough = (roughness_m - limits.roughness_m) / sigma;
      const double steep =
          (measured.slope_deg.at(place) - limits.slope_deg) / (sigma / slope_base_m * kDegrees);
      if (rough > 1 || steep > 1)
        sorted.p.at(place) = 0;
      else if (rough < -1 && steep < -1)
        sorted.p.at(place) = 1;
      else
        sorted.open.at(place) = 1;
    }
  });
  return sorted;
}

/// 2 z - denoise(z): what is smoothed away is given back (twicing, J. W. Tukey, Exploratory Data Analysis,
/// 1977).
Grid<double> restored(const Grid<double>& z, const Grid<double>& noise_m) {
  Grid<double> result = denoise(z, noise_m);
  for (std::size_t i = 0; i < z.spec().size(); ++i) {
    double& value = result.values()[i];
    value = 2 * z.values()[i] - value;
  }
  return result;
}

/// A ground whose means over bins `means` may be: sharpened, and with relief that the map does not show.
Grid<double> relief_ground(const Grid<double>& means, const Grid<double>& noise_m, Grid<double> relief_m) {
  const Grid<double> sharp = sharpen(means, relief_m);
  for (std::size_t i = 0; i < relief_m.spec().size(); ++i) {
    double& relief = relief_m.values()[i];
    relief = std::sqrt(kGroundShare * beyond_noise(relief * relief, noise_m.values()[i]));
  }
  return redrawn(sharp, relief_m, kReplicates);
}

/// PlaceMeasures in half of the memory.
struct FloatMeasures {
  Grid<float> slope_deg, roughness_m;
};

FloatMeasures narrowed(const PlaceMeasures& found) {
  const GridSpec& spec = found.slope_deg.spec();
  FloatMeasures result{Grid<float>::unset(spec), Grid<float>::unset(spec)};
  const auto narrow = [](double value) { return static_cast<float>(value); };
  std::ranges::transform(found.slope_deg.values(), result.slope_deg.values().begin(), narrow);
  std::ranges::transform(found.roughness_m.values(), result.roughness_m.values().begin(), narrow);
  return result;
}

/// The errors in replicates of a map whose bins hold `means`.
template <class Error>
FloatMeasures replicate_errors(const Grid<double>& means, const Grid<double>& noise_m, Grid<double> relief_m,
                               const BinMask& places, const Footprint& window, const MeasurePlaces& measure) {
  Error slope(means.spec());
  Error roughness(means.spec());
  const FloatMeasures truth = narrowed(measure(relief_ground(means, noise_m, std::move(relief_m)), places));
  for (std::size_t k = 0; k < kReplicates; ++k) {
    const Grid<double> replicate = denoise(redrawn(means, noise_m, k), noise_m);
    const PlaceMeasures again = measure(replicate, places);
    slope.add(truth.slope_deg, again.slope_deg);
    roughness.add(truth.roughness_m, again.roughness_m);
  }
  return {std::move(slope).over(window), std::move(roughness).over(window)};
}

}  // namespace

Grid<float> safe_probability(const Grid<double>& z, Grid<double> z_sigma, const LanderStencil& lander,
                             const HazardLimits& limits, double slope_base_m, const PlaceMeasures& measured,
                             const MeasurePlaces& measure) {
  const Footprint square = Footprint::square(lander.body.half_bins());
  Sorted sorted = sort_places(measured, z_sigma, square, limits, slope_base_m);
  SigmaParts sigma = split_sigma(z_sigma, square);
  z_sigma = Grid<double>();  // each map that is not needed any more makes room
  const Grid<double> denoised = denoise(z, sigma.noise_m);
  const BinMask places = sampled(sorted.open, square);
  const FloatMeasures variance =
      replicate_errors<ErrorVariance>(denoised, sigma.noise_m, sigma.relief_m, places, square, measure);
  const FloatMeasures bias =
      replicate_errors<ErrorMean>(restored(denoised, sigma.noise_m), sigma.noise_m,
                                  std::exchange(sigma.relief_m, {}), places, square, measure);
  const PlaceMeasures expected = measure(denoised, sorted.open);
  by_rows(z.spec().rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < z.spec().cols; ++col) {
      const BinIndex place{row, col};
      if (sorted.open.at(place) == 0) continue;
      const double rough = limits.roughness_m - expected.roughness_m.at(place) + bias.roughness_m.at(place);
      const double steep = limits.slope_deg - expected.slope_deg.at(place) + bias.slope_deg.at(place);
      sorted.p.at(place) = static_cast<float>(probability(rough, variance.roughness_m.at(place)) *
                                              probability(steep, variance.slope_deg.at(place)));
    }
  });
  return std::move(sorted.p);
}

}  // namespace landfall
