// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D285, D396, D462, D463
#include "chain/hazards/safe_probability.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/numerics/portable_math.h"
#include "base/raster/by_rows.h"
#include "base/raster/window_extremes.h"
#include "base/raster/window_mean.h"
#include "chain/hazards/reach.h"
#include "chain/hazards/terrain_posterior.h"

namespace landfall {
namespace {

constexpr double kStudentFreedom = 5;
/// Sigmas beyond which nothing is open: neither the map's own, nor those of the first terrains, where one
/// more terrain would be on the other side of a limit with a probability of kDoubt.
constexpr double kCertain = 8;
constexpr std::uint64_t kFirstTerrains = 3;
constexpr float kDoubt = 2.46e-4F;  // T(-kCertain)
constexpr double kMinPooled = 1e-12;

/// The largest sigma of the bins about a place; infinite where one was not measured.
Grid<double> largest_sigma(const SigmaParts& sigma, std::int64_t half_bins) {
  const GridSpec& spec = sigma.noise_m.spec();
  auto total = Grid<double>::unset(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const double value = portable::hypot(static_cast<double>(sigma.noise_m.values()[i]),
                                         static_cast<double>(sigma.relief_m.values()[i]));
    total.values()[i] = std::isnan(value) ? std::numeric_limits<double>::infinity() : value;
  }
  return window_max(total, half_bins);
}

/// P where nothing is open, and the places where it is.
struct Sorted {
  Grid<float> p;
  BinMask open;
};

Sorted sort_places(const MapEvidence& map, const HazardLimits& limits, double slope_base_m,
                   std::int64_t half_bins) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const GridSpec& spec = map.z.spec();
  const Grid<double> sigma = largest_sigma(map.sigma, half_bins);
  Sorted sorted{Grid<float>(spec, std::numeric_limits<float>::quiet_NaN()), BinMask(spec)};
  by_rows(spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex place{row, col};
      if (map.region.at(place) == 0) continue;
      const double doubt = kCertain * sigma.at(place);
      const double rough = map.measured.roughness_m.at(place) - limits.roughness_m;
      const double steep = (map.measured.slope_deg.at(place) - limits.slope_deg) / kDegrees * slope_base_m;
      if (rough > doubt || steep > doubt)
        sorted.p.at(place) = kDoubt;
      else if (rough < -doubt && steep < -doubt)
        sorted.p.at(place) = 1 - kDoubt;
      else
        sorted.open.at(place) = 1;
    }
  });
  return sorted;
}

/// Mean and sum of squared departures of a measure over the terrains, one terrain after the other (Welford).
class Moments {
 public:
  /// Variances are those of the places within half_bins.
  Moments(const GridSpec& spec, std::int64_t half_bins)
      : half_bins_(half_bins), mean_(spec), squares_(spec) {}

  /// The places' values on the terrain of this number, from 1 on.
  void add(const Grid<double>& values, const BinMask& places, double number) {
    by_rows(mean_.spec(), [&](std::int64_t row) {
      for (std::size_t c = 0; c < values.row(row).size(); ++c) {
        if (places.row(row)[c] == 0) continue;
        float& mean = mean_.row(row)[c];
        const double before = values.row(row)[c] - static_cast<double>(mean);
        mean += static_cast<float>(before / number);
        squares_.row(row)[c] += static_cast<float>(before * (values.row(row)[c] - static_cast<double>(mean)));
      }
    });
  }
  /// Student's t of the distance of one more terrain to the limit. `terrains` is how many each place was
  /// judged on, 0 for none. NaN where a value was.
  [[nodiscard]] double room(double limit, BinIndex place, const Grid<std::int8_t>& terrains) const {
    const double distance = limit - static_cast<double>(mean_.at(place));
    return distance / std::sqrt(pooled_variance(place, terrains) * (1 + 1.0 / terrains.at(place)));
  }

 private:
  [[nodiscard]] double pooled_variance(BinIndex place, const Grid<std::int8_t>& terrains) const {
    const GridSpec& spec = squares_.spec();
    double sum = 0;
    int freedom = 0;
    for (std::int64_t row = std::max<std::int64_t>(place.row - half_bins_, 0);
         row <= std::min(place.row + half_bins_, spec.rows - 1); ++row)
      for (std::int64_t col = std::max<std::int64_t>(place.col - half_bins_, 0);
           col <= std::min(place.col + half_bins_, spec.cols - 1); ++col) {
        const auto square = static_cast<double>(squares_.at({row, col}));
        const int count = terrains.at({row, col});
        if (count < 2 || std::isnan(square)) continue;
        sum += square;
        freedom += count - 1;
      }
    return std::max(sum / std::max(freedom, 1), kMinPooled);
  }

  std::int64_t half_bins_;
  Grid<float> mean_, squares_;
};

/// Student's distribution of 5 degrees of freedom (Abramowitz and Stegun, 26.7.3).
double student(double t) {
  const double angle = portable::atan(t / std::sqrt(kStudentFreedom));
  const double cosine = portable::cos(angle);
  return 0.5 + (angle + portable::sin(angle) * cosine * (1 + 2 * cosine * cosine / 3)) / std::numbers::pi;
}

std::int64_t lander_half_bins(const LanderStencil& lander) {
  return std::max(Reach::of_contact(lander).bins(), lander.body.half_bins());
}

/// The least doubt that the bins under the lander leave (see the header).
float min_doubt(std::int64_t known_bins) {
  return std::max(
      kDoubt, 1 / static_cast<float>(std::int64_t{kSafeTerrains} * std::max<std::int64_t>(known_bins, 1)));
}

/// Bounds P by the evidence of each place.
SafeProbability capped(Grid<float> p, const BinMask& known, const LanderStencil& lander) {
  const GridSpec& spec = p.spec();
  const std::int64_t all = lander.body.bin_count();
  Grid<std::int32_t> counts;
  if (count_set(known) < static_cast<std::int64_t>(spec.size())) {
    auto values = Grid<double>::unset(spec);
    for (std::size_t i = 0; i < spec.size(); ++i)
      values.values()[i] = known.values()[i] != 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
    counts = window_means(values, lander.body).count;
  }
  SafeProbability result{std::move(p), BinMask(spec)};
  for (std::size_t i = 0; i < spec.size(); ++i) {
    float& value = result.p.values()[i];
    const float cap = 1 - min_doubt(counts.spec().size() > 0 ? counts.values()[i] : all);
    if (std::isnan(value)) continue;
    result.cap = std::max(result.cap, cap);
    result.capped.values()[i] = value >= cap ? 1 : 0;
    value = std::clamp(value, kDoubt, cap);
  }
  return result;
}

}  // namespace

SafeProbability safe_probability(MapEvidence map, const LanderStencil& lander, const HazardLimits& limits,
                                 double slope_base_m, const MeasurePlaces& measure) {
  const GridSpec& spec = map.z.spec();
  Sorted sorted = sort_places(map, limits, slope_base_m, lander_half_bins(lander));
  BinMask known(spec);
  for (std::size_t i = 0; i < spec.size(); ++i)
    known.values()[i] = std::isnan(map.sigma.noise_m.values()[i]) ? 0 : 1;
  if (count_set(sorted.open) == 0) return capped(std::move(sorted.p), known, lander);
  const TerrainPosterior posterior(map.z, map.sigma.noise_m, map.seed,
                                   std::exchange(map.centroids, std::nullopt));
  map.sigma = {};  // makes room
  const std::int64_t pooled = lander.pad.half_bins() + 1;
  Moments slope(spec, pooled);
  Moments roughness(spec, pooled);
  Grid<std::int8_t> terrains(spec);
  const auto each_open = [&](const auto& work) {
    by_rows(spec, [&](std::int64_t row) {
      for (std::int64_t col = 0; col < spec.cols; ++col)
        if (sorted.open.at({row, col}) != 0) work(BinIndex{row, col});
    });
  };
  const auto count = [&](std::uint64_t k) {
    each_open([&](BinIndex place) { terrains.at(place) = static_cast<std::int8_t>(k); });
  };
  for (std::uint64_t k = 1; k <= kSafeTerrains; ++k) {
    const PlaceMeasures found = measure(posterior.draw(k), sorted.open);
    slope.add(found.slope_deg, sorted.open, static_cast<double>(k));
    roughness.add(found.roughness_m, sorted.open, static_cast<double>(k));
    count(k);
    if (k != kFirstTerrains) continue;
    BinMask clear(spec);
    each_open([&](BinIndex place) {
      const double steep = slope.room(limits.slope_deg, place, terrains);
      const double rough = roughness.room(limits.roughness_m, place, terrains);
      const bool is_safe = steep > kCertain && rough > kCertain;
      clear.at(place) = is_safe || steep < -kCertain || rough < -kCertain ? 1 : 0;
      if (clear.at(place) != 0) sorted.p.at(place) = is_safe ? 1 - kDoubt : kDoubt;
    });
    each_open([&](BinIndex place) { sorted.open.at(place) = clear.at(place) != 0 ? 0 : 1; });
  }
  each_open([&](BinIndex place) {
    sorted.p.at(place) = static_cast<float>(student(slope.room(limits.slope_deg, place, terrains)) *
                                            student(roughness.room(limits.roughness_m, place, terrains)));
  });
  return capped(std::move(sorted.p), known, lander);
}

std::int64_t safe_probability_reach(const LanderStencil& lander) {
  return TerrainPosterior::reach_bins(lander.resolution_m) + lander_half_bins(lander) +
         lander.pad.half_bins() + 1;
}

}  // namespace landfall
