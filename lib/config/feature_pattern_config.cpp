// SPDX-License-Identifier: GPL-3.0-or-later
#include <iterator>
#include <stdexcept>

#include "config/feature_config.h"
#include "config/json_values.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// A kind of pattern by its "type". To add one: its class (lib/terrain/features), a maker and an entry here,
/// a definition in schemas/terrain.schema.json.
struct PatternMaker {
  const char* type;
  FeaturePattern (*make)(const Json& json);
};

FeaturePattern make_ring(const Json& json) {
  return RingPattern{json.at("count").get<std::int64_t>(), json.at("radius_m").get<double>(),
                     radians(json, "first_azimuth_deg"), feature_shape(json.at("feature"))};
}

constexpr PatternMaker kPatterns[] = {
    {"ring", make_ring},
};
static_assert(std::size(kPatterns) == std::variant_size_v<FeaturePattern>);

}  // namespace

FeaturePattern feature_pattern(const Json& pattern) {
  for (const PatternMaker& maker : kPatterns)
    if (pattern.at("type") == maker.type) return maker.make(pattern);
  throw std::logic_error("no maker for " + pattern.at("type").dump());
}

}  // namespace landfall
