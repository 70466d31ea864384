// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D432
#include "formats/gdal/site_relation.h"

#include <cpl_conv.h>
#include <ogr_spatialref.h>

#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "base/text/characters.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/known_crs.h"
#include "formats/gdal/map_projection.h"

namespace landfall {
namespace {

OGRSpatialReference horizontal(const std::string& wkt) {
  require_crs_database("site frame");
  OGRSpatialReference crs;
  if (crs.importFromWkt(wkt.c_str()) != OGRERR_NONE) crs.Clear();
  crs.StripVertical();
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

bool is_nameless(const std::string& name) {
  const std::string lower = lower_case(name);
  return lower.empty() || lower == "unknown" || lower == "unnamed" || lower.find("not specified") == 0;
}

bool have_one_ellipsoid(const OGRSpatialReference& a, const OGRSpatialReference& b) {
  const Ellipsoid first = body_of(a);
  const Ellipsoid second = body_of(b);
  return std::abs(first.semi_major_m - second.semi_major_m) < 1e-3 &&
         std::abs(first.flattening - second.flattening) < 1e-8;
}

}  // namespace

std::string vertical_datum_of(const OGRSpatialReference& crs) {
  const auto text = [&](const char* node) {
    const char* const value = crs.GetAttrValue(node);
    return std::string(value != nullptr ? value : "");
  };
  if (crs.IsVertical() == 0) {
    const bool has_height = crs.GetAxesCount() == 3 && crs.IsGeocentric() == 0;
    return has_height ? "ellipsoid " + text("SPHEROID") : "";
  }
  const std::string datum = text("VERT_DATUM");
  const std::string name = is_nameless(datum) ? text("VERT_CS") : datum;
  if (lower_case(name).find("ellipsoid") == 0) return "ellipsoid " + text("SPHEROID");
  return is_nameless(name) ? "" : name;
}

std::string datum_shift(const OGRSpatialReference& from, const OGRSpatialReference& to) {
  if (have_one_ellipsoid(from, to)) return "";
  const auto name = [](const OGRSpatialReference& crs) {
    const char* const datum = crs.GetAttrValue("DATUM");
    return std::string(datum != nullptr ? datum : "unnamed");
  };
  return "the shift between the datums " + name(from) + " and " + name(to) +
         " is the best of the grids that PROJ finds on this machine";
}

bool is_one_map(const std::string& a_wkt, const std::string& b_wkt) {
  const GdalErrors errors;
  const OGRSpatialReference a = horizontal(a_wkt);
  const OGRSpatialReference b = horizontal(b_wkt);
  return a.IsEmpty() == 0 && b.IsEmpty() == 0 && a.IsSame(&b) != 0;
}

SiteTransform transform_between(const std::string& from_wkt, const std::string& to_wkt) {
  const GdalErrors errors;
  const OGRSpatialReference from = horizontal(from_wkt);
  const OGRSpatialReference to = horizontal(to_wkt);
  if (from.IsProjected() == 0 || to.IsProjected() == 0) return {};
  // Without the shift between two datums a transformation is off by up to 200 m: none is better. Datums on
  // one ellipsoid (of a planet by two names) have no shift.
  OGRCoordinateTransformationOptions options;
  options.SetBallparkAllowed(have_one_ellipsoid(from, to));
  const std::shared_ptr<OGRCoordinateTransformation> made(
      OGRCreateCoordinateTransformation(&from, &to, options));
  if (!made) return {};
  const auto move = [made](std::span<double> x_m, std::span<double> y_m) {
    const GdalErrors silenced;
    std::vector<int> done(x_m.size(), TRUE);
    made->Transform(static_cast<int>(x_m.size()), x_m.data(), y_m.data(), nullptr, done.data());
    for (std::size_t i = 0; i < done.size(); ++i)
      if (done[i] == FALSE || !std::isfinite(x_m[i]) || !std::isfinite(y_m[i]))
        x_m[i] = y_m[i] = std::numeric_limits<double>::quiet_NaN();
  };
  return {move, datum_shift(from, to)};
}

std::string proj_text_of(const std::string& wkt) {
  const GdalErrors errors;
  char* text = nullptr;
  const OGRErr status = horizontal(wkt).exportToProj4(&text);
  const std::string proj = text != nullptr ? text : "";
  CPLFree(text);
  return status == OGRERR_NONE ? proj.substr(0, proj.find_last_not_of(' ') + 1) : "";
}

}  // namespace landfall
