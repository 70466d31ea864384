// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/vertical_unit.h"

#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <string>

#include "base/abbreviated.h"
#include "base/error.h"
#include "base/number_text.h"

namespace landfall {
namespace {

struct Unit {
  const char* name;
  double metres;
};

constexpr double kUsSurveyFoot_m = 1200.0 / 3937.0;

/// Names in lower case, without blanks, underscores, hyphens, and without the s of a plural.
constexpr Unit kUnits[] = {{"m", 1},
                           {"metre", 1},
                           {"meter", 1},
                           {"km", 1000},
                           {"kilometre", 1000},
                           {"kilometer", 1000},
                           {"dm", 0.1},
                           {"decimetre", 0.1},
                           {"decimeter", 0.1},
                           {"cm", 0.01},
                           {"centimetre", 0.01},
                           {"centimeter", 0.01},
                           {"mm", 0.001},
                           {"millimetre", 0.001},
                           {"millimeter", 0.001},
                           {"ft", 0.3048},
                           {"foot", 0.3048},
                           {"feet", 0.3048},
                           {"internationalfoot", 0.3048},
                           {"internationalfeet", 0.3048},
                           {"ftus", kUsSurveyFoot_m},
                           {"usft", kUsSurveyFoot_m},
                           {"footus", kUsSurveyFoot_m},
                           {"ussurveyft", kUsSurveyFoot_m},
                           {"ussurveyfoot", kUsSurveyFoot_m},
                           {"ussurveyfeet", kUsSurveyFoot_m}};

std::string normalised(const std::string& unit) {
  std::string name;
  for (const char c : unit)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (name.size() > 2 && name.back() == 's' && name != "ftus" && name != "footus") name.pop_back();
  return name;
}

[[noreturn]] void refuse(const DemBase& dem, const std::string& what) {
  throw FormatError(dem.path + ": band " + std::to_string(dem.band) + " " + what +
                        "; give the metres per unit as vertical_scale",
                    "vertical_scale");
}

/// The unit that the band declares; none where it declares none.
std::optional<double> band_unit_m(GDALRasterBand& band, const DemBase& dem) {
  const char* const declared = band.GetUnitType();
  const std::string unit = declared != nullptr ? declared : "";
  const std::string name = normalised(unit);
  if (name.empty() || name == "1" || name == "none" || name == "unknown") return std::nullopt;
  for (const Unit& known : kUnits)
    if (name == known.name) return known.metres;
  refuse(dem, "has the unit '" + abbreviated(unit) + "', which is not a known unit of length");
}

/// The unit of the heights of a compound or three-dimensional CRS; none for a horizontal one.
std::optional<double> crs_unit_m(const OGRSpatialReference* crs) {
  if (crs == nullptr) return std::nullopt;
  double metres = 0;
  if (crs->IsCompound() != 0) {
    metres = crs->GetTargetLinearUnits("VERT_CS");
  } else if (crs->GetAxesCount() == 3) {
    crs->GetAxis(nullptr, 2, nullptr, &metres);
  }
  return std::isfinite(metres) && metres > 0 ? std::optional(metres) : std::nullopt;
}

}  // namespace

double metres_per_elevation_unit(const OpenRaster& raster, const DemBase& dem) {
  if (dem.vertical_scale) return 1;
  const std::optional<double> band_m = band_unit_m(*raster.band, dem);
  const std::optional<double> crs_m = crs_unit_m(georeference(raster).crs);
  if (band_m && crs_m && std::abs(*band_m - *crs_m) > 1e-9 * *crs_m)
    refuse(dem, "declares elevations in units of " + number_text(*band_m) + " m, its CRS in units of " +
                    number_text(*crs_m) + " m");
  return band_m.value_or(crs_m.value_or(1));
}

}  // namespace landfall
