// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/safe_probability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "hazards/padded_map.h"
#include "raster/window_mean.h"

namespace landfall {
namespace {

constexpr std::size_t kRowsPerPiece = 16;
constexpr std::int64_t kReach = 2;
constexpr double kCertain = 8;  // sigma
constexpr std::size_t kReplicates = 2;
constexpr std::uint64_t kSeed = 1;

template <class Work>
void by_rows(std::int64_t rows, const Work& work) {
  parallel_for(static_cast<std::size_t>(rows), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) work(static_cast<std::int64_t>(row));
  });
}

/// The weight of a neighbour in the value at the centre of the least-squares quadratic surface through the 24
/// bins around it: the first row of (A^T A)^-1 A^T. By symmetry the surface's terms in x, y and x y do not
/// matter there, and those in x^2 and y^2 have one coefficient: with n = 24, sum x^2 = 50, sum x^4 = 170,
/// sum x^2 y^2 = 100, the equations n a + 100 b = 1 and 50 a + 270 b = 0.
double weight(std::int64_t rows, std::int64_t cols) {
  constexpr double kDeterminant = 24.0 * 270 - 50.0 * 100;
  return (270 - 50 * static_cast<double>(rows * rows + cols * cols)) / kDeterminant;
}

struct Neighbour {
  BinOffset offset;
  double weight;
};

std::vector<Neighbour> neighbours() {
  std::vector<Neighbour> found;
  for (std::int64_t row = -kReach; row <= kReach; ++row)
    for (std::int64_t col = -kReach; col <= kReach; ++col)
      if (row != 0 || col != 0) found.push_back({{row, col}, weight(row, col)});
  return found;
}

/// What the bins around say of a bin: NaN where one is missing.
struct Predictions {
  PaddedMap z, noise;  ///< value, and its variance by the noise of the bins
  PaddedMap excess;    ///< squared misfit of the bin less its expectation
};

Predictions predict(const Grid<double>& z_map, const Grid<double>& sigma_map) {
  const GridSpec& spec = z_map.spec();
  const PaddedMap z(z_map, kReach);
  const PaddedMap sigma(sigma_map, kReach);
  Predictions found{PaddedMap(spec, 1), PaddedMap(spec, 1), PaddedMap(spec, 1)};
  const std::vector<Neighbour> around = neighbours();
  by_rows(spec.rows, [&](std::int64_t row) {
    double* const value = found.z.at(row, 0);
    double* const noise = found.noise.at(row, 0);
    double* const excess = found.excess.at(row, 0);
    std::fill_n(value, spec.cols, 0);
    std::fill_n(noise, spec.cols, 0);
    for (const Neighbour& n : around) {
      const double* const from = z.at(row + n.offset.rows, n.offset.cols);
      const double* const sigma_from = sigma.at(row + n.offset.rows, n.offset.cols);
      for (std::int64_t c = 0; c < spec.cols; ++c) {
        value[c] += n.weight * from[c];
        noise[c] += n.weight * n.weight * (sigma_from[c] * sigma_from[c]);
      }
    }
    const double* const own = z.at(row, 0);
    const double* const own_sigma = sigma.at(row, 0);
    for (std::int64_t c = 0; c < spec.cols; ++c) {
      const double misfit = own[c] - value[c];
      excess[c] = misfit * misfit - (noise[c] + own_sigma[c] * own_sigma[c]);
    }
  });
  return found;
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

/// The changes of a measure when noise is drawn again; NaN where it was not taken.
class Changes {
 public:
  explicit Changes(const GridSpec& spec) : mean_(spec), mean_square_(spec) {}

  /// Call kReplicates times, then average().
  void add(const Grid<double>& before, const Grid<double>& after) {
    for (std::size_t i = 0; i < before.spec().size(); ++i) {
      const double change = after.values()[i] - before.values()[i];
      mean_.values()[i] += change / kReplicates;
      mean_square_.values()[i] += change * change / kReplicates;
    }
  }
  void average(const Footprint& window) {
    mean_ = window_means(mean_, window).mean;
    mean_square_ = window_means(mean_square_, window).mean;
  }

  /// Phi((limit - value + mean) / std).
  [[nodiscard]] double probability(BinIndex place, double limit, double value) const {
    const double mean = mean_.at(place);
    const double variance = mean_square_.at(place) - mean * mean;
    const double room = limit - value + mean;
    if (!(variance > 0)) return room >= 0 ? 1 : 0;
    return 0.5 * std::erfc(-room / std::sqrt(2 * variance));
  }

 private:
  Grid<double> mean_, mean_square_;
};

/// The mean variance of the bins in the window about each.
Grid<double> mean_variance(const Grid<double>& sigma, const Footprint& window) {
  Grid<double> variance = sigma;
  for (double& value : variance.values()) value *= value;
  return window_means(variance, window).mean;
}

}  // namespace

DenoisedMap denoise(const Grid<double>& z, const Grid<double>& z_sigma) {
  const GridSpec& spec = z.spec();
  const Predictions predicted = predict(z, z_sigma);
  DenoisedMap result{z, Grid<double>(spec)};
  by_rows(spec.rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const double sigma = z_sigma.at({row, col});
      const double own = sigma * sigma;
      double departure = 0;
      for (std::int64_t r = -1; r <= 1; ++r)
        for (std::int64_t c = -1; c <= 1; ++c) departure += predicted.excess.at(row + r, col + c)[0] / 9;
      const double other = *predicted.noise.at(row, col) + std::max(departure, 0.0);
      double& variance = result.variance.at({row, col});
      variance = own;
      if (!std::isfinite(departure) || !(other > 0)) continue;
      double& height = result.z.at({row, col});
      height += (*predicted.z.at(row, col) - height) * (own / (own + other));
      variance = own * other / (own + other);
    }
  });
  return result;
}

Grid<float> safe_probability(const Grid<double>& z, const Grid<double>& z_sigma, const LanderStencil& lander,
                             const HazardLimits& limits, double slope_base_m, const PlaceMeasures& measured,
                             const MeasurePlaces& measure) {
  const GridSpec& spec = z.spec();
  const DenoisedMap denoised = denoise(z, z_sigma);
  const Footprint square = Footprint::square(lander.body.half_bins());
  constexpr double kDegrees = 180 / std::numbers::pi;
  const Grid<double> variance = mean_variance(z_sigma, square);
  Grid<float> p(spec, std::numeric_limits<float>::quiet_NaN());
  BinMask open(spec);
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
        p.at(place) = 0;
      else if (rough < -1 && steep < -1)
        p.at(place) = 1;
      else
        open.at(place) = 1;
    }
  });
  const PlaceMeasures expected = measure(denoised.z, open);
  Changes slope(spec);
  Changes roughness(spec);
  for (std::size_t k = 0; k < kReplicates; ++k) {
    const PlaceMeasures again = measure(denoise(redrawn(denoised.z, z_sigma, k), z_sigma).z, open);
    slope.add(expected.slope_deg, again.slope_deg);
    roughness.add(expected.roughness_m, again.roughness_m);
  }
  slope.average(square);
  roughness.average(square);
  by_rows(spec.rows, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex place{row, col};
      if (open.at(place) == 0) continue;
      p.at(place) = static_cast<float>(
          roughness.probability(place, limits.roughness_m, expected.roughness_m.at(place)) *
          slope.probability(place, limits.slope_deg, expected.slope_deg.at(place)));
    }
  });
  return p;
}

}  // namespace landfall
