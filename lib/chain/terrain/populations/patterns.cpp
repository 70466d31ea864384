// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D116, D255
#include "chain/terrain/populations/patterns.h"

#include <algorithm>
#include <cmath>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr double kAxisRatio = 0.8;
constexpr double kMaxHeightRatio = 0.75;

// Further draws of an object. Part of the files' reproducibility: never renumber.
constexpr std::uint64_t kYawDraw = 0;
constexpr std::uint64_t kHeightDraw = 1;
constexpr std::uint64_t kFreshnessDraw = 2;
constexpr std::uint64_t kTiltDraw = 3;

/// Largest distance from the middle of the bottom, at the greatest tilt and height (IceBlock::reach_m).
double ice_block_reach() {
  const double tilt = IceBlockPattern::kMaxTilt_rad;
  return portable::hypot(0.5, kAxisRatio / 2 * portable::cos(tilt) + kMaxHeightRatio * portable::sin(tilt));
}

/// The longer axis of an ellipse, in diameters of the disc of the same area.
const double kLongerAxis = 1 / std::sqrt(kAxisRatio);

PopulationKind rocks() { return {"rock", RandomStream::rock_population, kLongerAxis / 2, false}; }
PopulationKind ice_block_kind() {
  return {"ice block", RandomStream::ice_block_population, ice_block_reach(), false};
}
PopulationKind crater_kind() { return {"crater", RandomStream::crater_population, 0.75, true}; }

/// The objects as features; shape(sampler, object) makes the shape of one.
template <class F>
std::vector<Feature> features_of(const PopulationSampler& sampler, const F& shape) {
  const std::vector<ScatteredObject> objects = sampler.objects();
  std::vector<Feature> features(objects.size());
  parallel_for(objects.size(), kObjectsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      features[i] = {objects[i].point.x_m, objects[i].point.y_m, shape(objects[i])};
  });
  return features;
}

double yaw_rad(const PopulationSampler& sampler, const ScatteredObject& object) {
  return 2 * std::numbers::pi * sampler.uniform(object, kYawDraw);
}

double height_m(const PopulationSampler& sampler, const ScatteredObject& object) {
  const double ratio = 0.5 + 0.1 * sampler.normal(object, kHeightDraw);
  return object.diameter_m * std::clamp(ratio, 0.25, kMaxHeightRatio);
}

}  // namespace

void RockPattern::require_bounded(const PatternSite& site) const {
  static_cast<void>(PopulationSampler(population, rocks(), site));
}

std::vector<Feature> RockPattern::features(const PatternSite& site) const {
  const PopulationSampler sampler(population, rocks(), site);
  return features_of(sampler, [&](const ScatteredObject& object) {
    return Rock{kLongerAxis * object.diameter_m, height_m(sampler, object), kAxisRatio,
                yaw_rad(sampler, object), object.diameter_m};
  });
}

void IceBlockPattern::validate(const std::string& owner) const {
  population.validate(owner);
  require(max_tilt_rad >= 0 && max_tilt_rad <= kMaxTilt_rad, {owner, "max_tilt_rad"}, max_tilt_rad,
          "in [0, 0.2618] (15 deg)");
}

void IceBlockPattern::require_bounded(const PatternSite& site) const {
  static_cast<void>(PopulationSampler(population, ice_block_kind(), site));
}

std::vector<Feature> IceBlockPattern::features(const PatternSite& site) const {
  const PopulationSampler sampler(population, ice_block_kind(), site);
  return features_of(sampler, [&](const ScatteredObject& object) {
    const double tilt_rad = max_tilt_rad * (2 * sampler.uniform(object, kTiltDraw) - 1);
    return IceBlock{object.diameter_m, kAxisRatio * object.diameter_m, height_m(sampler, object),
                    yaw_rad(sampler, object), tilt_rad};
  });
}

void CraterPattern::validate(const std::string& owner) const {
  population.validate(owner);
  require(freshness_min > 0 && freshness_min <= 1, {owner, "freshness_min"}, freshness_min, "in (0, 1]");
}

void CraterPattern::require_bounded(const PatternSite& site) const {
  static_cast<void>(PopulationSampler(population, crater_kind(), site));
}

std::vector<Feature> CraterPattern::features(const PatternSite& site) const {
  const PopulationSampler sampler(population, crater_kind(), site);
  return features_of(sampler, [&](const ScatteredObject& object) {
    const double freshness = freshness_min + (1 - freshness_min) * sampler.uniform(object, kFreshnessDraw);
    return Crater{object.diameter_m, 0, freshness};
  });
}

}  // namespace landfall
