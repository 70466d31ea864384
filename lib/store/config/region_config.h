// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/raster/polygon.h"

namespace landfall {

/// The bins of RegionShape::mask and polygon: in a layer of an HDF5 file, in polygons of a file, or in those
/// that the configuration holds.
struct RegionSource {
  RegionShape shape = RegionShape::mask;
  std::string path, layer;
  std::vector<Polygon> polygons = {};  ///< without a path
};

/// The key `region` of the configurations of dem-eval and hazard-map.
struct RegionConfig {
  RegionShape shape = RegionShape::circle;
  Horizontal center_m = {};
  std::optional<double> half_width_m = std::nullopt;  ///< of the square
  std::optional<RegionSource> source = std::nullopt;
};

/// A circle about the origin without the key. Throws UsageError "NAME: /region..." for keys that the shape
/// lacks or that belong to another shape, and as require_simple() does.
[[nodiscard]] RegionConfig region_config(const nlohmann::json& resolved, const std::string& name);

/// A vertex or position [x, y].
[[nodiscard]] Horizontal horizontal(const nlohmann::json& pair);
[[nodiscard]] Polygon::Ring ring_of(const nlohmann::json& vertices);

}  // namespace landfall
