// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D112
//
// At most 10^7 expected objects per pattern, about 3 GB of memory; more is refused before anything is
// drawn.
#include "chain/terrain/populations/population.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"
#include "chain/terrain/populations/disc_packing.h"

namespace landfall {
namespace {

constexpr std::uint64_t kAttempts = 1000;

// Draws of one object. Part of the files' reproducibility: never renumber.
constexpr std::uint64_t kSizeDraw = 0;
constexpr std::uint64_t kFurtherDraws = 8;
constexpr std::uint64_t kPlaceDraws = 16;  // two for each attempt
static_assert(kPlaceDraws + 2 * kAttempts <= std::uint64_t{1} << kDrawBits);

std::uint64_t draw_key(int exponent, std::size_t number) {
  return static_cast<std::uint64_t>(exponent + 2000) << 40U | static_cast<std::uint64_t>(number);
}

int octave_of(std::uint64_t key) { return static_cast<int>(key >> 40U) - 2000; }

/// n with 2^n < value <= 2^(n+1).
int octave_below(double value) {
  const int exponent = std::ilogb(value);
  return std::ldexp(1, exponent) == value ? exponent - 1 : exponent;
}

}  // namespace

void Population::validate(const std::string& owner) const {
  landfall::validate(law, owner);
  require_positive({owner, "min_diameter_m"}, diameters.min_m);
  require(diameters.max_m > diameters.min_m && diameters.max_m < 1e6, {owner, "max_diameter_m"},
          diameters.max_m, "greater than min_diameter_m and less than 1e6");
  landfall::validate(region, owner + "/region");
  require_not_negative({owner, "clear_radius_m"}, clear_radius_m);
  const double maximum = 4294967295;
  require(!seed || *seed <= 4294967295U, {owner, "seed"}, seed ? static_cast<double>(*seed) : maximum,
          "in 0..4294967295");
}

PopulationSampler::PopulationSampler(const Population& population, const PopulationKind& kind,
                                     const PatternSite& site)
    : population_(population),
      kind_(kind),
      site_{site.west_m, site.east_m, site.south_m, site.north_m},
      pattern_(site.pattern),
      seed_(population.seed.value_or(site.pattern)),
      random_(site.seed, kind.stream) {
  require_bounded();
}

std::string PopulationSampler::name() const { return "patterns/" + std::to_string(pattern_); }

PopulationSampler::Octave PopulationSampler::octave(int exponent) const {
  const double top_m = std::ldexp(1, exponent + 1);
  const Box site = kind_.from_outside ? site_.widened(kind_.reach * top_m) : site_;
  const double bottom_m = std::max(std::ldexp(1, exponent), population_.diameters.min_m);
  return {exponent, {bottom_m, top_m}, bounds(population_.region, site)};
}

std::vector<PopulationSampler::Octave> PopulationSampler::octaves() const {
  std::vector<Octave> list;
  const int last = octave_below(population_.diameters.max_m);
  for (int exponent = last; std::ldexp(1, exponent + 1) > population_.diameters.min_m; --exponent) {
    list.push_back(octave(exponent));
    if (list.back().box.empty()) list.pop_back();
  }
  return list;
}

void PopulationSampler::require_bounded() const {
  const std::vector<Octave> list = octaves();
  if (list.empty()) throw UsageError(name() + "/region: does not meet the site");
  double expected = 0;
  for (const Octave& o : list)
    expected += o.box.area_m2() * (density_per_m2(population_.law, o.diameters.min_m) -
                                   density_per_m2(population_.law, o.diameters.max_m));
  if (expected <= kMaxObjects) return;
  if (std::isnan(expected)) expected = std::numeric_limits<double>::infinity();  // infinity - infinity
  throw UsageError(name() + ": about " + number_text(std::round(expected)) + " " + kind_.name +
                   "s would be drawn, more than " + number_text(kMaxObjects) + "; raise min_diameter_m");
}

double PopulationSampler::uniform(const ScatteredObject& object, std::uint64_t draw) const {
  return random_.uniform(object.key, seed_ << kDrawBits | (kFurtherDraws + draw));
}

double PopulationSampler::normal(const ScatteredObject& object, std::uint64_t draw) const {
  return random_.normal(object.key, seed_ << kDrawBits | (kFurtherDraws + draw));
}

SitePoint PopulationSampler::draw_point(std::uint64_t key, std::uint64_t attempt, const Box& box) const {
  const std::uint64_t draw = seed_ << kDrawBits | (kPlaceDraws + 2 * attempt);
  return {box.west_m + random_.uniform(key, draw) * (box.east_m - box.west_m),
          box.south_m + random_.uniform(key, draw + 1) * (box.north_m - box.south_m)};
}

bool PopulationSampler::admits(const ScatteredObject& object) const {
  const double reach_m = kind_.reach * object.diameter_m;
  const Box site = kind_.from_outside ? site_.widened(reach_m) : site_;
  const bool is_clear =
      population_.clear_radius_m == 0 ||
      portable::hypot(object.point.x_m, object.point.y_m) >= population_.clear_radius_m + reach_m;
  return is_clear && site.contains(object.point) && contains(population_.region, object.point);
}

std::vector<ScatteredObject> PopulationSampler::draw(const Octave& octave) const {
  const double at_top = density_per_m2(population_.law, octave.diameters.max_m);
  const double at_bottom = density_per_m2(population_.law, octave.diameters.min_m);
  std::vector<double> densities;
  double events = 0;
  for (std::size_t i = 0;; ++i) {
    events -=
        portable::log(1 - random_.uniform(draw_key(octave.exponent, i), seed_ << kDrawBits | kSizeDraw));
    densities.push_back(at_top + events / octave.box.area_m2());
    if (!(densities.back() < at_bottom)) break;
  }
  densities.pop_back();
  std::vector<ScatteredObject> objects(densities.size());
  parallel_for(objects.size(), kObjectsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint64_t key = draw_key(octave.exponent, i);
      objects[i] = {draw_point(key, 0, octave.box),
                    diameter_m(population_.law, densities[i], octave.diameters), key};
    }
  });
  std::erase_if(objects, [&](const ScatteredObject& object) {
    return object.diameter_m > population_.diameters.max_m || !admits(object);
  });
  return objects;
}

void PopulationSampler::spread(std::vector<ScatteredObject>& objects) const {
  DiscPacking packing;
  for (ScatteredObject& object : objects) {
    const Box box = octave(octave_of(object.key)).box;
    const auto is_free = [&] {
      return admits(object) &&
             packing.add_if_free({object.point.x_m, object.point.y_m, kind_.reach * object.diameter_m});
    };
    std::uint64_t attempt = 0;
    while (!is_free()) {
      if (++attempt == kAttempts)
        throw UsageError(name() + "/overlap: a " + kind_.name + " of " + number_text(object.diameter_m) +
                         " m finds no free position in " + std::to_string(kAttempts) +
                         " draws; allow overlap, raise min_diameter_m or use a lower density");
      object.point = draw_point(object.key, attempt, box);
    }
  }
}

std::vector<ScatteredObject> PopulationSampler::objects() const {
  std::vector<ScatteredObject> all;
  for (const Octave& o : octaves()) {
    const std::vector<ScatteredObject> drawn = draw(o);
    all.insert(all.end(), drawn.begin(), drawn.end());
  }
  if (!population_.overlap) spread(all);
  return all;
}

}  // namespace landfall
