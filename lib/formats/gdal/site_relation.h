// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <string>

class OGRSpatialReference;

namespace landfall {

/// Moves points from one site frame to another, in place; NaN where a point has no position in the other
/// frame. Not from several threads.
using SitePointMover = std::function<void(std::span<double> x_m, std::span<double> y_m)>;

struct SiteTransform {
  SitePointMover move;      ///< empty: there is none
  std::string datum_shift;  ///< datum_shift() of the two frames
};

/// The name of a CRS's vertical datum: "EGM96 geoid", or "ellipsoid NAME" for heights above the ellipsoid.
/// Empty where the CRS gives none.
[[nodiscard]] std::string vertical_datum_of(const OGRSpatialReference& crs);

/// Says that PROJ shifts positions from one datum to another, which depends on the grids that are installed;
/// empty where both are on one ellipsoid.
[[nodiscard]] std::string datum_shift(const OGRSpatialReference& from, const OGRSpatialReference& to);

/// one_map() and site_transform() of gdal_loader.h.
[[nodiscard]] bool is_one_map(const std::string& a_wkt, const std::string& b_wkt);
[[nodiscard]] SiteTransform transform_between(const std::string& from_wkt, const std::string& to_wkt);

/// The CRS as a PROJ text, for a command that a user can type; empty where it has none.
[[nodiscard]] std::string proj_text_of(const std::string& wkt);

}  // namespace landfall
