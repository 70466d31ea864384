// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <stdexcept>

#include "base/core/error.h"
#include "store/config/feature_config.h"
#include "store/config/json_values.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

SitePoint center_of(const Json& json) { return {number(json, "x_m"), number(json, "y_m")}; }

Region region_of(const Json& json) {
  const auto type = json.at("type").get<std::string>();
  if (type == "rectangle")
    return RectangleRegion{center_of(json), number(json, "width_m"), number(json, "length_m")};
  if (type == "disc") return AnnulusRegion{center_of(json), 0, number(json, "radius_m")};
  if (type == "annulus")
    return AnnulusRegion{center_of(json), number(json, "inner_radius_m"), number(json, "outer_radius_m")};
  return SiteRegion{};
}

GolombekLaw golombek_law(const Json& json, const std::string& owner) {
  if (json.contains("k") == json.contains("area_fraction"))
    throw UsageError(owner + ": give either k or area_fraction");
  const double above_m = number(json, "area_fraction_above_m");
  if (json.contains("area_fraction"))
    return GolombekLaw::covering(number(json, "area_fraction"), above_m, owner + "/area_fraction");
  if (above_m != 0)
    throw UsageError(owner + "/area_fraction_above_m: is allowed only with area_fraction, not with k");
  return {number(json, "k")};
}

/// The power law that the configuration names `own`, with its two parameters.
PowerLaw own_law(const Json& json, const std::string& owner, const std::string& own) {
  if (!json.contains("coefficient") || !json.contains("exponent"))
    throw UsageError(owner + "/model: " + own + " needs coefficient and exponent");
  return {number(json, "coefficient"), number(json, "exponent")};
}

void require_no_own_law(const Json& json, const std::string& owner, const std::string& own) {
  for (const char* const key : {"coefficient", "exponent"})
    if (json.contains(key))
      throw UsageError(owner + "/" + key + ": is allowed only with model " + own + ", not with " +
                       json.at("model").get<std::string>());
}

PowerLaw rock_law(const Json& json, const std::string& owner) {
  const auto model = json.at("model").get<std::string>();
  if (model == "custom") return own_law(json, owner, model);
  require_no_own_law(json, owner, "custom");
  if (model == "low_blocky") return kLowBlockyRocks;
  return model == "haworth" ? kHaworthRocks : kViperRocks;
}

SizeLaw crater_law(const Json& json, const std::string& owner) {
  const auto model = json.at("model").get<std::string>();
  if (model == "production") return own_law(json, owner, model);
  require_no_own_law(json, owner, "production");
  if (model == "viper") return ViperCraterLaw{};
  return kTraskCraters;
}

Population population_of(const Json& json, const SizeLaw& law) {
  Population population;
  population.law = law;
  population.diameters = {number(json, "min_diameter_m"), number(json, "max_diameter_m")};
  population.region = region_of(json.at("region"));
  population.clear_radius_m = number(json, "clear_radius_m");
  population.overlap = json.at("overlap").get<bool>();
  if (json.contains("seed")) population.seed = json.at("seed").get<std::uint64_t>();
  return population;
}

RockPattern golombek_rocks(const Json& pattern, const std::string& owner) {
  return {population_of(pattern, golombek_law(pattern, owner))};
}

RockPattern power_law_rocks(const Json& pattern, const std::string& owner) {
  return {population_of(pattern, rock_law(pattern, owner))};
}

IceBlockPattern ice_blocks(const Json& pattern, const std::string& owner) {
  return {population_of(pattern, golombek_law(pattern, owner)), radians(pattern, "max_tilt_deg")};
}

CraterPattern craters(const Json& pattern, const std::string& owner) {
  return {population_of(pattern, crater_law(pattern, owner)), number(pattern, "freshness_min")};
}

LinePattern lines(const Json& pattern, const std::string& owner) {
  constexpr double kSquareMetresPerSquareKilometre = 1e6;
  const FeatureShape shape = feature_shape(pattern.at("feature"));
  LinePattern made;
  if (const auto* const ridge = std::get_if<Ridge>(&shape))
    made.shape = *ridge;
  else if (const auto* const fracture = std::get_if<Fracture>(&shape))
    made.shape = *fracture;
  else
    throw UsageError(owner + "/feature/type: must be ridge or fracture");
  made.density_per_m2 = number(pattern, "density_per_km2") / kSquareMetresPerSquareKilometre;
  made.shortest_m = pattern.contains("shortest_m")
                        ? number(pattern, "shortest_m")
                        : std::visit([](const auto& line) { return line.length_m; }, made.shape);
  made.yaw_spread_rad = radians(pattern, "yaw_spread_deg");
  if (pattern.contains("seed")) made.seed = pattern.at("seed").get<std::uint64_t>();
  return made;
}

/// A kind of pattern by its "type". To add one: its class (lib/chain/terrain/features or populations), a
/// maker and an entry here, and a definition in schemas/terrain.schema.json. `owner` begins messages.
struct PatternMaker {
  const char* type;
  FeaturePattern (*make)(const Json& json, const std::string& owner);
};

/// Adapts a maker of one kind of pattern.
template <auto make>
FeaturePattern made(const Json& json, const std::string& owner) {
  return make(json, owner);
}

RingPattern ring(const Json& json, const std::string& /*owner*/) {
  return RingPattern{json.at("count").get<std::int64_t>(), json.at("radius_m").get<double>(),
                     radians(json, "first_azimuth_deg"), feature_shape(json.at("feature"))};
}

constexpr PatternMaker kFeaturePatterns[] = {
    {"ring", made<ring>},
    {"golombek_rocks", made<golombek_rocks>},
    {"power_law_rocks", made<power_law_rocks>},
    {"ice_blocks", made<ice_blocks>},
    {"craters", made<craters>},
    {"lines", made<lines>},
};
static_assert(std::size(kFeaturePatterns) ==
              std::variant_size_v<FeaturePattern> + 1);  // rocks have two types

}  // namespace

FeaturePattern feature_pattern(const Json& pattern, const std::string& owner) {
  for (const PatternMaker& maker : kFeaturePatterns)
    if (pattern.at("type") == maker.type) return maker.make(pattern, owner);
  throw std::logic_error("no maker for " + pattern.at("type").dump());
}

}  // namespace landfall
