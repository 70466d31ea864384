// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <stdexcept>

#include "config/feature_config.h"
#include "config/json_values.h"
#include "config/population_config.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// A kind of pattern by its "type". To add one: its class (lib/terrain/features or populations), a maker and
/// an entry here, and a definition in schemas/terrain.schema.json. `owner` begins messages.
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
