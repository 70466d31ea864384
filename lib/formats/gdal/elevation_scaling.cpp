// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D39, D375
#include "formats/gdal/elevation_scaling.h"

#include <cpl_json.h>
#include <ogr_spatialref.h>

#include <cmath>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "base/units/spelled_unit.h"

namespace landfall {
namespace {

/// A unit of elevations, and who declares it.
struct DeclaredUnit {
  std::string where;
  double metres;
  bool downwards = false;
};

[[noreturn]] void refuse(const DemBase& dem, const std::string& what) {
  throw FormatError(dem.path + ": band " + std::to_string(dem.band) + " " + what +
                        "; give the metres per unit as vertical_scale",
                    "vertical_scale");
}

void add_spelled(std::vector<DeclaredUnit>& units, const std::string& where, const std::string& text,
                 const DemBase& dem) {
  if (says_no_unit(text)) return;
  const SpelledUnit unit = spelled_unit(text);
  if (!(unit.metres > 0))
    refuse(dem, "has the unit '" + abbreviated(text) + "', which is not a known unit of length");
  units.push_back({where, unit.metres, unit.downwards});
}

/// UNIT of the IMAGE object of a PDS3 label, else the unit of its scaling factor ("0.5 <METER>").
std::string pds3_unit(GDALDataset& dataset) {
  char** const label = dataset.GetMetadata("json:PDS");
  CPLJSONDocument document;
  if (label == nullptr || label[0] == nullptr || !document.LoadMemory(std::string(label[0]))) return "";
  const CPLJSONObject image = document.GetRoot().GetObj("IMAGE");
  if (!image.IsValid()) return "";
  if (std::string unit = image.GetString("UNIT"); !says_no_unit(unit)) return unit;
  const CPLJSONObject factor = image.GetObj("SCALING_FACTOR");
  return factor.IsValid() ? factor.GetString("unit") : "";
}

/// The vertical axis of a compound or three-dimensional CRS; none of a horizontal one.
std::optional<DeclaredUnit> crs_unit(const OGRSpatialReference* crs) {
  if (crs == nullptr) return std::nullopt;
  double metres = 0;
  OGRAxisOrientation orientation = OAO_Up;
  if (crs->IsCompound() != 0) {
    metres = crs->GetTargetLinearUnits("VERT_CS");
    crs->GetAxis("VERT_CS", 0, &orientation);
  } else if (crs->GetAxesCount() == 3) {
    crs->GetAxis(nullptr, 2, &orientation, &metres);
  }
  if (!(std::isfinite(metres) && metres > 0)) return std::nullopt;
  return DeclaredUnit{"its CRS", metres, orientation == OAO_Down};
}

std::vector<DeclaredUnit> declared_units(const OpenRaster& raster, const DemBase& dem,
                                         const std::optional<FileArray>& array,
                                         const OGRSpatialReference* crs) {
  std::vector<DeclaredUnit> units;
  const char* const of_band = raster.band->GetUnitType();
  add_spelled(units, "the band", of_band != nullptr ? of_band : "", dem);
  if (units.empty() && array) add_spelled(units, "the array", array->unit, dem);
  add_spelled(units, "its label", pds3_unit(*raster.dataset), dem);
  if (const auto unit = crs_unit(crs)) units.push_back(*unit);
  return units;
}

void require_one_unit(const std::vector<DeclaredUnit>& units, const DemBase& dem) {
  for (const DeclaredUnit& unit : units)
    if (std::abs(unit.metres - units.front().metres) > 1e-9 * unit.metres)
      refuse(dem, "declares elevations in units of " + number_text(units.front().metres) + " m, " +
                      unit.where + " in units of " + number_text(unit.metres) + " m");
}

bool counts_downwards(const std::vector<DeclaredUnit>& units, const std::optional<FileArray>& array) {
  if (array && array->downwards) return true;
  for (const DeclaredUnit& unit : units)
    if (unit.downwards) return true;
  return false;
}

/// Metres where the map is in other units: the usual case, but not a certain one.
void say_assumed_metres(const Georeference& reference, std::vector<std::string>& assumed) {
  const bool has_other_unit = reference.metres_per_unit > 0 && std::abs(reference.metres_per_unit - 1) > 1e-9;
  if (has_other_unit)
    assumed.push_back("the elevations declare no unit, and the map is in units of " +
                      short_number(reference.metres_per_unit) +
                      " m: elevations in metres are assumed (vertical_scale gives another unit)");
}

}  // namespace

Scaling packing_of(const OpenRaster& raster, const DemBase& dem, const std::optional<FileArray>& array) {
  int given = 0;
  Scaling scaling;
  const double scale = raster.band->GetScale(&given);
  bool any = given != 0 && scale != 1;
  if (given != 0) scaling.scale = scale;
  const double offset = raster.band->GetOffset(&given);
  any = any || (given != 0 && offset != 0);
  if (given != 0) scaling.offset = offset;
  if (!any && array) scaling = {array->scale.value_or(1), array->offset.value_or(0)};
  if (!std::isfinite(scaling.scale) || !std::isfinite(scaling.offset) || scaling.scale == 0)
    throw FormatError(dem.path + ": band " + std::to_string(dem.band) + " has a scale of 0 or not finite");
  return scaling;
}

Scaling elevation_scaling(const OpenRaster& raster, const DemBase& dem, const std::optional<FileArray>& array,
                          RasterStatement& statement) {
  const Scaling& packed = statement.packing;
  std::vector<std::string>& assumed = statement.assumed;
  if (dem.vertical_scale) {
    const bool downwards = array && array->downwards;
    if (downwards && *dem.vertical_scale > 0)
      assumed.push_back("its elevations count downwards, which a positive vertical_scale keeps");
    return packed;
  }
  const std::vector<DeclaredUnit> units = declared_units(raster, dem, array, statement.georeference.crs);
  require_one_unit(units, dem);
  if (units.empty()) say_assumed_metres(statement.georeference, assumed);
  double metres = units.empty() ? 1 : units.front().metres;
  if (counts_downwards(units, array)) {
    metres = -metres;
    assumed.push_back(
        "its elevations count downwards: their sign is changed (vertical_scale decides otherwise)");
  }
  return {packed.scale * metres, packed.offset * metres};
}

}  // namespace landfall
