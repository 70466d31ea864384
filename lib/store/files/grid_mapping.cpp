// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D247
#include "store/files/grid_mapping.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <string_view>

#include "base/text/split_text.h"

namespace landfall {
namespace {

/// KEYWORD["text", 1.5, word, KEYWORD[...], ...]
struct WktNode {
  std::string_view keyword;
  std::vector<std::string_view> values;  ///< texts without their quotes, numbers, words
  std::vector<WktNode> nodes;

  [[nodiscard]] const WktNode* find(std::initializer_list<std::string_view> keywords) const {
    for (const WktNode& node : nodes)
      if (std::find(keywords.begin(), keywords.end(), node.keyword) != keywords.end()) return &node;
    return nullptr;
  }
  [[nodiscard]] std::string text(std::size_t i) const {
    return i < values.size() ? std::string(values[i]) : "";
  }
  [[nodiscard]] std::optional<double> number(std::size_t i) const {
    const auto value = i < values.size() ? exact_number<double>(values[i]) : std::nullopt;
    return value && std::isfinite(*value) ? value : std::nullopt;
  }
};

/// A text from a file: its depth is limited, and anything unexpected ends the parsing.
class WktParser {
 public:
  explicit WktParser(std::string_view text) : rest_(text) {}

  std::optional<WktNode> parse() {
    WktNode node;
    const std::string_view keyword = word();
    if (!parse_list(keyword, node, 0)) return std::nullopt;
    skip_blanks();
    return rest_.empty() ? std::optional(std::move(node)) : std::nullopt;
  }

 private:
  static constexpr int kMaxDepth = 20;

  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0)
      rest_.remove_prefix(1);
  }
  bool skip(char c) {
    skip_blanks();
    if (rest_.empty() || rest_.front() != c) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::string_view word() {
    skip_blanks();
    const std::size_t size = std::min(rest_.find_first_of("[],\" \t\r\n"), rest_.size());
    const std::string_view result = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return result;
  }
  bool parse_list(std::string_view keyword, WktNode& node, int depth) {
    node.keyword = keyword;
    if (keyword.empty() || depth > kMaxDepth || !skip('[')) return false;
    do {
      if (!parse_item(node, depth)) return false;
    } while (skip(','));
    return skip(']');
  }
  bool parse_item(WktNode& node, int depth) {
    if (skip('"')) {
      const std::size_t size = rest_.find('"');
      if (size == std::string_view::npos) return false;
      node.values.push_back(rest_.substr(0, size));
      rest_.remove_prefix(size + 1);
      return true;
    }
    const std::string_view name = word();
    skip_blanks();
    if (rest_.empty() || rest_.front() != '[') {
      node.values.push_back(name);
      return !name.empty();
    }
    return parse_list(name, node.nodes.emplace_back(), depth + 1);
  }

  std::string_view rest_;
};

/// CF's name of a parameter of a WKT2 conversion.
struct Parameter {
  std::string_view wkt;
  std::string_view cf;
  /// For a parameter that CF lacks: the only value for which CF's mapping is the same one.
  std::optional<double> fixed = std::nullopt;
};

struct Projection {
  std::string_view method;
  const char* cf_name;
  std::vector<Parameter> parameters;
};

constexpr std::string_view kLatitude = "Latitude of natural origin";
constexpr std::string_view kLongitude = "Longitude of natural origin";
constexpr std::string_view kScale = "Scale factor at natural origin";

/// Appendix F of CF-1.8, as far as PROJ's WKT2 names the same projections. The false easting and northing are
/// added to each.
const std::vector<Projection>& projections() {
  static const Parameter kOriginLatitude{kLatitude, "latitude_of_projection_origin"};
  static const Parameter kOriginLongitude{kLongitude, "longitude_of_projection_origin"};
  static const Parameter kOriginScale{kScale, "scale_factor_at_projection_origin"};
  static const std::vector<Parameter> kConic = {
      {"Latitude of 1st standard parallel", "standard_parallel"},
      {"Latitude of 2nd standard parallel", "standard_parallel"},
      {"Latitude of false origin", "latitude_of_projection_origin"},
      {"Longitude of false origin", "longitude_of_central_meridian"}};
  static const std::vector<Projection> kProjections = {
      {"Albers Equal Area", "albers_conical_equal_area", kConic},
      {"Azimuthal Equidistant", "azimuthal_equidistant", {kOriginLatitude, kOriginLongitude}},
      {"Modified Azimuthal Equidistant", "azimuthal_equidistant", {kOriginLatitude, kOriginLongitude}},
      {"Lambert Azimuthal Equal Area", "lambert_azimuthal_equal_area", {kOriginLatitude, kOriginLongitude}},
      {"Lambert Azimuthal Equal Area (Spherical)",
       "lambert_azimuthal_equal_area",
       {kOriginLatitude, kOriginLongitude}},
      {"Lambert Conic Conformal (1SP)",
       "lambert_conformal_conic",
       {{kLatitude, "standard_parallel"},
        kOriginLatitude,
        {kLongitude, "longitude_of_central_meridian"},
        {kScale, "", 1}}},
      {"Lambert Conic Conformal (2SP)", "lambert_conformal_conic", kConic},
      {"Mercator (variant A)", "mercator", {{kLatitude, "", 0}, kOriginLongitude, kOriginScale}},
      {"Mercator (variant B)",
       "mercator",
       {{"Latitude of 1st standard parallel", "standard_parallel"}, kOriginLongitude}},
      {"Orthographic", "orthographic", {kOriginLatitude, kOriginLongitude}},
      {"Polar Stereographic (variant A)",
       "polar_stereographic",
       {kOriginLatitude, {kLongitude, "straight_vertical_longitude_from_pole"}, kOriginScale}},
      {"Polar Stereographic (variant B)",
       "polar_stereographic",
       {{"Latitude of standard parallel", "standard_parallel"},
        {"Longitude of origin", "straight_vertical_longitude_from_pole"}}},
      {"Sinusoidal", "sinusoidal", {kOriginLongitude}},
      {"Stereographic", "stereographic", {kOriginLatitude, kOriginLongitude, kOriginScale}},
      {"Transverse Mercator",
       "transverse_mercator",
       {kOriginLatitude,
        {kLongitude, "longitude_of_central_meridian"},
        {kScale, "scale_factor_at_central_meridian"}}}};
  return kProjections;
}

/// The value of a parameter in degrees, metres or as a ratio.
std::optional<double> value_of(const WktNode& parameter) {
  const std::optional<double> value = parameter.number(1);
  if (!value) return std::nullopt;
  if (const WktNode* const unit = parameter.find({"ANGLEUNIT"})) {
    if (unit->text(0) == "degree") return value;  // as given: no rounding by the factor
    const std::optional<double> radians = unit->number(1);
    return radians ? std::optional(*value * *radians * 180 / std::numbers::pi) : std::nullopt;
  }
  const WktNode* const unit = parameter.find({"LENGTHUNIT", "SCALEUNIT"});
  const std::optional<double> factor = unit != nullptr ? unit->number(1) : std::optional(1.0);
  return factor ? std::optional(*value * *factor) : std::nullopt;
}

const WktNode* parameter_of(const WktNode& conversion, std::string_view name) {
  for (const WktNode& node : conversion.nodes)
    if (node.keyword == "PARAMETER" && !node.values.empty() && node.values[0] == name) return &node;
  return nullptr;
}

/// Adds a number; a second standard_parallel joins the first.
void add_number(GridMapping& mapping, std::string_view name, double value) {
  if (!mapping.numbers.empty() && mapping.numbers.back().first == name)
    mapping.numbers.back().second.push_back(value);
  else
    mapping.numbers.emplace_back(name, std::vector<double>{value});
}

bool add_parameter(GridMapping& mapping, const WktNode& conversion, const Parameter& wanted) {
  const WktNode* const parameter = parameter_of(conversion, wanted.wkt);
  const std::optional<double> value = parameter != nullptr ? value_of(*parameter) : std::nullopt;
  if (!value || (wanted.fixed && *value != *wanted.fixed)) return false;
  if (!wanted.fixed) add_number(mapping, wanted.cf, *value);
  return true;
}

/// The false easting or northing.
bool add_false_origin(GridMapping& mapping, const WktNode& conversion, const std::string& axis) {
  const std::string capital = axis == "easting" ? "Easting" : "Northing";
  return add_parameter(mapping, conversion, {"False " + axis, "false_" + axis}) ||
         add_parameter(mapping, conversion, {capital + " at false origin", "false_" + axis});
}

bool add_conversion(GridMapping& mapping, const WktNode& conversion) {
  const WktNode* const method = conversion.find({"METHOD", "PROJECTION"});
  if (method == nullptr) return false;
  const auto known = std::ranges::find(projections(), method->text(0), &Projection::method);
  if (known == projections().end()) return false;
  mapping.texts.emplace_back("grid_mapping_name", known->cf_name);
  for (const Parameter& parameter : known->parameters)
    if (!add_parameter(mapping, conversion, parameter)) return false;
  if (method->text(0) == "Polar Stereographic (variant B)")  // the pole is that of the standard parallel
    add_number(mapping, "latitude_of_projection_origin", mapping.numbers.front().second[0] < 0 ? -90 : 90);
  return add_false_origin(mapping, conversion, "easting") &&
         add_false_origin(mapping, conversion, "northing");
}

/// The figure of the body, its prime meridian, and the names of both.
bool add_body(GridMapping& mapping, const WktNode& base) {
  const WktNode* const datum = base.find({"DATUM", "ENSEMBLE", "GEODETICDATUM"});
  const WktNode* const ellipsoid = datum != nullptr ? datum->find({"ELLIPSOID"}) : nullptr;
  const std::optional<double> axis = ellipsoid != nullptr ? value_of(*ellipsoid) : std::nullopt;
  const std::optional<double> inverse_flattening = ellipsoid != nullptr ? ellipsoid->number(2) : std::nullopt;
  if (!axis || !inverse_flattening) return false;
  if (*inverse_flattening == 0) {
    add_number(mapping, "earth_radius", *axis);  // CF's word for the radius of any spherical body
  } else {
    add_number(mapping, "semi_major_axis", *axis);
    add_number(mapping, "inverse_flattening", *inverse_flattening);
  }
  const WktNode* const meridian = base.find({"PRIMEM"});
  const std::optional<double> longitude = meridian != nullptr ? value_of(*meridian) : std::optional(0.0);
  if (!longitude) return false;
  add_number(mapping, "longitude_of_prime_meridian", *longitude);
  mapping.texts.emplace_back("geographic_crs_name", base.text(0));
  mapping.texts.emplace_back("horizontal_datum_name", datum->text(0));
  mapping.texts.emplace_back("reference_ellipsoid_name", ellipsoid->text(0));
  mapping.texts.emplace_back("prime_meridian_name", meridian != nullptr ? meridian->text(0) : "Greenwich");
  return true;
}

/// True if every axis, or the coordinate system as a whole, is in metres.
bool is_in_metres(const WktNode& crs) {
  bool any = false;
  for (const WktNode& node : crs.nodes) {
    const WktNode* const unit = node.keyword == "LENGTHUNIT" ? &node : node.find({"LENGTHUNIT"});
    if ((node.keyword != "LENGTHUNIT" && node.keyword != "AXIS") || unit == nullptr) continue;
    if (unit->number(1) != 1) return false;
    any = true;
  }
  return any;
}

}  // namespace

std::optional<GridMapping> grid_mapping_of(const std::string& wkt) {
  const std::optional<WktNode> crs = WktParser(wkt).parse();
  if (!crs || (crs->keyword != "PROJCRS" && crs->keyword != "PROJECTEDCRS") || !is_in_metres(*crs))
    return std::nullopt;
  const WktNode* const base = crs->find({"BASEGEOGCRS", "BASEGEODCRS"});
  const WktNode* const conversion = crs->find({"CONVERSION"});
  GridMapping mapping;
  if (base == nullptr || conversion == nullptr || !add_conversion(mapping, *conversion) ||
      !add_body(mapping, *base))
    return std::nullopt;
  mapping.texts.emplace_back("projected_crs_name", crs->text(0));
  return mapping;
}

bool is_local_crs(const std::string& wkt) {
  const std::optional<WktNode> crs = WktParser(wkt).parse();
  constexpr std::array<std::string_view, 3> kLocal = {"ENGCRS", "ENGINEERINGCRS", "LOCAL_CS"};
  return crs && std::ranges::find(kLocal, crs->keyword) != kLocal.end();
}

}  // namespace landfall
