// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/populations/line_pattern.h"

#include <cmath>

#include "base/numerics/portable_math.h"
#include "base/numerics/random.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/populations/population.h"
#include "chain/terrain/populations/region.h"

namespace landfall {
namespace {

// Draws of one line. Part of the files' reproducibility: never renumber.
constexpr std::uint64_t kCountDraw = 0;
constexpr std::uint64_t kXDraw = 1;
constexpr std::uint64_t kYDraw = 2;
constexpr std::uint64_t kLengthDraw = 3;
constexpr std::uint64_t kLineYawDraw = 4;

template <class Shape>
Shape with_length(Shape shape, double length_m) {
  shape.length_m = length_m;
  return shape;
}

/// The site, extended by the reach of the longest line.
Box centres(const LinePattern& pattern, const PatternSite& site) {
  const double reach_m = std::visit([](const auto& shape) { return shape.reach_m(); }, pattern.shape);
  return Box{site.west_m, site.east_m, site.south_m, site.north_m}.widened(reach_m);
}

}  // namespace

void LinePattern::validate(const std::string& owner) const {
  require_positive({owner, "density_per_m2"}, density_per_m2);
  require(yaw_spread_rad >= 0 && yaw_spread_rad <= std::numbers::pi / 2, {owner, "yaw_spread_rad"},
          yaw_spread_rad, "in [0, pi / 2]");
  require(!seed || *seed <= 4294967295U, {owner, "seed"}, seed ? static_cast<double>(*seed) : 0,
          "in 0..4294967295");
  std::visit(
      [&](const auto& line) {
        line.validate(owner + "/feature");
        require(shortest_m > 0 && shortest_m <= line.length_m, {owner, "shortest_m"}, shortest_m,
                "in (0, the feature's length_m]");
        require(line.taper_m <= shortest_m / 2, {owner + "/feature", "taper_m"}, line.taper_m,
                "at most half of shortest_m");
      },
      shape);
}

void LinePattern::require_bounded(const PatternSite& site) const {
  const double expected = density_per_m2 * centres(*this, site).area_m2();
  if (expected <= kMaxLines) return;
  throw UsageError("patterns/" + std::to_string(site.pattern) + ": about " +
                   number_text(std::round(expected)) + " lines would be drawn, more than " +
                   number_text(kMaxLines) + "; use a lower density");
}

std::vector<Feature> LinePattern::features(const PatternSite& site) const {
  require_bounded(site);
  const Box box = centres(*this, site);
  const double expected = density_per_m2 * box.area_m2();
  const RandomField random(site.seed, RandomStream::line_population);
  const std::uint64_t own_seed = seed.value_or(site.pattern) << kDrawBits;
  std::vector<Feature> lines;
  double events = 0;
  for (std::uint64_t i = 0;; ++i) {
    const auto uniform = [&](std::uint64_t draw) { return random.uniform(i, own_seed | draw); };
    events -= portable::log(1 - uniform(kCountDraw));
    if (!(events < expected)) return lines;
    const auto line = [&](auto copy) -> FeatureShape {
      copy.yaw_rad += yaw_spread_rad * (2 * uniform(kLineYawDraw) - 1);
      return with_length(copy, shortest_m + uniform(kLengthDraw) * (copy.length_m - shortest_m));
    };
    lines.push_back({box.west_m + uniform(kXDraw) * (box.east_m - box.west_m),
                     box.south_m + uniform(kYDraw) * (box.north_m - box.south_m), std::visit(line, shape)});
  }
}

}  // namespace landfall
