// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/features/feature.h"

#include <cmath>
#include <numbers>

#include "base/numerics/portable_math.h"

namespace landfall {

namespace {

template <class... Shapes>
std::vector<std::string> kinds_of(const std::variant<Shapes...>& /*any*/) {
  return {Shapes::kName...};
}

}  // namespace

const std::vector<std::string>& feature_kinds() {
  static const std::vector<std::string> kKinds = kinds_of(FeatureShape{});
  return kKinds;
}

void validate(const FeatureShape& shape, const std::string& owner) {
  std::visit([&](const auto& s) { s.validate(owner); }, shape);
}

void RingPattern::validate(const std::string& owner) const {
  require(count >= 1 && count <= 1'000'000, {owner, "count"}, static_cast<double>(count), "in 1..1000000");
  require(std::isfinite(radius_m) && radius_m >= 0, {owner, "radius_m"}, radius_m, "finite and >= 0");
  require_finite({owner, "first_azimuth_rad"}, first_azimuth_rad);
  landfall::validate(shape, owner + "/feature");
}

std::vector<Feature> RingPattern::features(const PatternSite& /*site*/) const {
  std::vector<Feature> ring;
  ring.reserve(static_cast<std::size_t>(count));
  const double step_rad = 2 * std::numbers::pi / static_cast<double>(count);
  for (std::int64_t i = 0; i < count; ++i) {
    const double azimuth_rad = first_azimuth_rad + static_cast<double>(i) * step_rad;
    ring.push_back({radius_m * portable::cos(azimuth_rad), radius_m * portable::sin(azimuth_rad), shape});
  }
  return ring;
}

}  // namespace landfall
