// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D370
#include "formats/gdal/raster_statement.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "base/units/spelled_unit.h"
#include "formats/gdal/elevation_scaling.h"

namespace landfall {
namespace {

using Coefficients = std::array<double, 6>;

[[noreturn]] void contradiction(const DemBase& dem, const std::string& what) {
  throw FormatError(dem.path + ": contradicts itself: " + what +
                    "; correct one of them (ncatted, gdal_translate -a_srs)");
}

/// The units of the two coordinate variables, easting first.
struct AxisUnits {
  std::array<std::string, 2> names;
  std::array<std::string, 2> texts;
  std::array<SpelledUnit, 2> units;

  explicit AxisUnits(const FileArray& array) {
    const bool transposed = array.columns.is_northing || array.rows.is_easting;
    const FileAxis& x = transposed ? array.rows : array.columns;
    const FileAxis& y = transposed ? array.columns : array.rows;
    names = {x.name, y.name};
    texts = {x.unit, y.unit};
    for (std::size_t i = 0; i < 2; ++i)
      if (!says_no_unit(texts[i])) units[i] = spelled_unit(texts[i]);
  }
  [[nodiscard]] bool unsaid(std::size_t i) const { return says_no_unit(texts[i]); }
  [[nodiscard]] std::string quoted() const {
    return names[0] + " in '" + abbreviated(texts[0]) + "', " + names[1] + " in '" + abbreviated(texts[1]) +
           "'";
  }
};

/// The size of the unit of a CRS: metres, or radians for a geographic one.
double map_unit(const OGRSpatialReference& crs) {
  return crs.IsGeographic() != 0 ? crs.GetAngularUnits() : crs.GetLinearUnits();
}

/// The factor from the units of a coordinate variable to those of the CRS; 1 where it declares none.
double factor_to_crs(const AxisUnits& axes, std::size_t i, const OGRSpatialReference& crs,
                     const DemBase& dem) {
  if (axes.unsaid(i)) return 1;
  const bool angles = crs.IsGeographic() != 0;
  const double unit = angles ? axes.units[i].radians : axes.units[i].metres;
  if (!(unit > 0))
    contradiction(dem, "coordinate variable '" + axes.names[i] + "' is in '" + abbreviated(axes.texts[i]) +
                           "', its CRS in " + (angles ? "angles" : "lengths"));
  const double factor = unit / map_unit(crs);
  return std::abs(factor - 1) < 1e-9 ? 1 : factor;
}

/// Without a CRS: metres per unit of the coordinates, 0 where they do not say.
double declared_metres(const AxisUnits& axes, Coefficients& transform, const DemBase& dem) {
  const auto is_length = [&](std::size_t i) { return axes.units[i].metres > 0; };
  for (std::size_t i = 0; i < 2; ++i) {
    const bool unknown = !axes.unsaid(i) && !is_length(i) && !(axes.units[i].radians > 0);
    if (unknown && !dem.horizontal_scale_m)
      throw FormatError(dem.path + ": coordinate variable '" + axes.names[i] + "' has the unit '" +
                            abbreviated(axes.texts[i]) +
                            "', which is not a known unit of length; give horizontal_scale_m",
                        "horizontal_scale_m");
  }
  if (is_length(0) != is_length(1) && !dem.horizontal_scale_m)
    contradiction(dem, "coordinate variables " + axes.quoted());
  if (!is_length(0) || !is_length(1)) return 0;
  const double y_factor = axes.units[1].metres / axes.units[0].metres;
  for (std::size_t i = 3; i < 6; ++i) transform.at(i) *= y_factor;
  return axes.units[0].metres;
}

/// The largest distance, in pixels, between the positions of the raster's corners under two georeferences.
double distance_px(const Coefficients& a, const Coefficients& b, const RasterSize& size) {
  const GeoTransform transform(a);
  const GeoTransform other(b);
  if (!transform.invertible() || !other.invertible()) return std::numeric_limits<double>::infinity();
  double distance = 0;
  for (const double col : {0.0, static_cast<double>(size.cols - 1)})
    for (const double row : {0.0, static_cast<double>(size.rows - 1)}) {
      const PixelPosition pixel = transform.pixel(other.map_point({col, row}));
      distance = std::max({distance, std::abs(pixel.col - col), std::abs(pixel.row - row)});
    }
  return distance;
}

std::string spacing_text(const Coefficients& c) {
  return "(" + short_number(c[1] + c[2]) + ", " + short_number(c[4] + c[5]) + ")";
}

constexpr double kTolerance_px = 1e-2;

/// The georeference by the coordinate variables, which win over that of GDAL (CF: the coordinates are data).
void take_axes(const FileArray& array, const DemBase& dem, Georeference& reference,
               const std::optional<Coefficients>& of_gdal, bool stored_georeference,
               std::vector<std::string>& assumed) {
  auto own = axes_transform(array, dem);
  if (!own) return;
  const AxisUnits axes(array);
  bool contradicts_unit = false;
  if (reference.crs == nullptr) {
    reference.metres_per_unit = declared_metres(axes, *own, dem);
  } else {
    const double x_factor = factor_to_crs(axes, 0, *reference.crs, dem);
    const double y_factor = factor_to_crs(axes, 1, *reference.crs, dem);
    contradicts_unit = x_factor != 1 || y_factor != 1;
    for (std::size_t i = 0; i < 3; ++i) own->at(i) *= x_factor;
    for (std::size_t i = 3; i < 6; ++i) own->at(i) *= y_factor;
  }
  const bool agree = of_gdal && distance_px(*own, *of_gdal, reference.size) < kTolerance_px;
  if (agree) return;
  reference.transform = GeoTransform(*own);
  // If neither units nor a stored georeference contradict them, GDAL only derived it from them in its way.
  if (of_gdal && (contradicts_unit || stored_georeference))
    assumed.push_back("its coordinate variables (" + axes.quoted() +
                      ") and its georeference differ, spacings " + spacing_text(*own) + " and " +
                      spacing_text(*of_gdal) + " in units of the map: the coordinate variables are used");
}

/// Rasters without arrays whose driver passes on the units of coordinate variables.
double metres_by_metadata(GDALDataset& dataset) {
  const auto metres = [&](const char* item) {
    const char* const text = dataset.GetMetadataItem(item);
    return text != nullptr && !says_no_unit(text) ? spelled_unit(text).metres : 0;
  };
  const double x = metres("x#units");
  return x > 0 && x == metres("y#units") ? x : 0;
}

/// GDAL's own attribute GeoTransform of the grid mapping, which other tools keep when they cut a raster.
bool stores_georeference(GDALDataset& dataset) {
  for (char** item = dataset.GetMetadata(); item != nullptr && *item != nullptr; ++item)
    if (std::string_view(*item).find("#GeoTransform=") != std::string_view::npos) return true;
  return false;
}

std::string name_of(const OGRSpatialReference& crs) {
  return crs.GetName() != nullptr ? crs.GetName() : "unnamed";
}

Georeference georeference(const OpenRaster& raster, const DemBase& dem, const std::optional<FileArray>& array,
                          std::vector<std::string>& assumed) {
  Georeference result;
  result.size = raster.size;
  std::optional<Coefficients> of_gdal;
  Coefficients coefficients{};
  if (raster.dataset->GetGeoTransform(coefficients.data()) == CE_None) {
    of_gdal = coefficients;
    result.transform = GeoTransform(coefficients);
  }
  const OGRSpatialReference* crs = raster.dataset->GetSpatialRef();
  if (crs != nullptr && !crs->IsEmpty()) result.crs = crs;
  if (const OGRSpatialReference* const given = raster.given_crs.get()) {
    if (result.crs != nullptr && result.crs->IsSame(given) == 0)
      assumed.push_back("its CRS is " + name_of(*result.crs) + ", but crs gives " + name_of(*given) +
                        ", which is used");
    result.crs = given;
  }
  if (result.crs == nullptr && of_gdal) result.metres_per_unit = metres_by_metadata(*raster.dataset);
  if (array) take_axes(*array, dem, result, of_gdal, stores_georeference(*raster.dataset), assumed);
  if (result.crs != nullptr && result.crs->IsGeographic() == 0 && result.crs->IsGeocentric() == 0)
    result.metres_per_unit = result.crs->GetLinearUnits();
  return result;
}

/// The raw sample that GDAL takes for "no data", in the type of the band.
std::optional<double> gdal_nodata(GDALRasterBand& band) {
  int given = 0;
  double value = 0;
  if (band.GetRasterDataType() == GDT_Int64)
    value = static_cast<double>(band.GetNoDataValueAsInt64(&given));
  else if (band.GetRasterDataType() == GDT_UInt64)
    value = static_cast<double>(band.GetNoDataValueAsUInt64(&given));
  else
    value = band.GetNoDataValue(&given);
  if (given == 0) return std::nullopt;
  return is_signed_byte(band) ? as_signed_byte(value) : value;
}

}  // namespace

RasterStatement raster_statement(const OpenRaster& raster, const DemBase& dem) {
  RasterStatement result;
  const std::optional<FileArray> array = file_array(raster, dem);
  result.georeference = georeference(raster, dem, array, result.assumed);
  result.packing = packing_of(raster, dem, array);
  result.elevation = elevation_scaling(raster, dem, array, result);
  if (const auto nodata = gdal_nodata(*raster.band)) result.nodata.push_back(*nodata);
  result.nodata.insert(result.nodata.end(), dem.nodata.begin(), dem.nodata.end());
  if (array) {
    result.nodata.insert(result.nodata.end(), array->fills.begin(), array->fills.end());
    result.valid = array->valid;
  }
  return result;
}

}  // namespace landfall
