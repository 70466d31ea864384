// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/region_config.h"

#include <algorithm>
#include <map>

#include "base/core/error.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// The shapes that have a key.
const std::map<std::string, std::vector<std::string>>& owners() {
  static const std::map<std::string, std::vector<std::string>> owners = {{"center_m", {"circle"}},
                                                                         {"half_width_m", {"square"}},
                                                                         {"path", {"mask", "polygon"}},
                                                                         {"layer", {"mask", "polygon"}},
                                                                         {"vertices", {"polygon"}}};
  return owners;
}

void refuse_foreign_keys(const Json& region, const std::string& shape, const std::string& name) {
  for (const auto& [key, shapes] : owners())
    if (region.contains(key) && std::ranges::find(shapes, shape) == shapes.end())
      throw UsageError(name + ": /region/" + key + ": is allowed only with the shape " + shapes.front() +
                       (shapes.size() > 1 ? " or " + shapes.back() : "") + ", not with " + shape +
                       "; set /region/shape to \"" + shapes.front() + "\"");
}

void require_key(const Json& region, const char* key, const std::string& shape, const std::string& name) {
  if (!region.contains(key))
    throw UsageError(name + ": /region: the shape " + shape + " needs the key \"" + key + "\"");
}

void require_polygon(const Json& region, const std::string& name) {
  if (region.contains("path") == region.contains("vertices"))
    throw UsageError(name + ": /region: the shape polygon needs one of the keys \"path\" and \"vertices\"");
  if (region.contains("layer") && region.contains("vertices"))
    throw UsageError(name + ": /region/layer: is a layer of the file in path, which vertices replace");
}

RegionShape shape_of(const std::string& name) {
  return name == "circle"   ? RegionShape::circle
         : name == "square" ? RegionShape::square
         : name == "mask"   ? RegionShape::mask
                            : RegionShape::polygon;
}

RegionSource source_of(RegionShape shape, const Json& region, const std::string& name) {
  RegionSource source{shape, region.value("path", ""), region.value("layer", "")};
  if (shape == RegionShape::mask && source.layer.empty()) source.layer = "mask";
  if (region.contains("vertices")) {
    source.polygons.emplace_back(std::vector<Polygon::Ring>{ring_of(region.at("vertices"))});
    require_simple(source.polygons.front(), name + ": /region/vertices");
  }
  return source;
}

}  // namespace

Horizontal horizontal(const Json& pair) { return {pair.at(0), pair.at(1)}; }

Polygon::Ring ring_of(const Json& vertices) {
  Polygon::Ring ring;
  for (const Json& vertex : vertices) ring.push_back(horizontal(vertex));
  return ring;
}

RegionConfig region_config(const Json& resolved, const std::string& name) {
  if (!resolved.contains("region")) return {};
  const Json& region = resolved.at("region");
  const std::string shape = region.at("shape");
  refuse_foreign_keys(region, shape, name);
  RegionConfig config{.shape = shape_of(shape)};
  if (region.contains("center_m")) config.center_m = horizontal(region.at("center_m"));
  if (shape == "square") {
    require_key(region, "half_width_m", shape, name);
    config.half_width_m = region.at("half_width_m");
  }
  if (shape == "mask") require_key(region, "path", shape, name);
  if (shape == "polygon") require_polygon(region, name);
  if (has_mask(config.shape)) config.source = source_of(config.shape, region, name);
  return config;
}

}  // namespace landfall
