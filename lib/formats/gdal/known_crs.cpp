// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D447
#include "formats/gdal/known_crs.h"

#include <cstdlib>

#include "base/core/error.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

/// Why PROJ cannot use its database; empty where it can. GDAL opens it, which takes some 15 ms, only once.
std::string database_fault() {
  const GdalErrors errors;
  OGRSpatialReference any;
  return any.importFromEPSG(4326) == OGRERR_NONE ? "" : errors.reason();
}

/// "PROJ_LIB=/nonexistent": the variables that are set.
std::string variables() {
  std::string text;
  for (const char* const name : {"PROJ_DATA", "PROJ_LIB", "PROJ_AUX_DB"})
    if (const char* const value = std::getenv(name))
      text += (text.empty() ? "" : " and ") + std::string(name) + "=" + abbreviated(value);
  return text;
}

}  // namespace

void require_crs_database(const std::string& name) {
  static const std::string fault = database_fault();
  if (fault.empty()) return;
  const std::string set = variables();
  throw FormatError(name + ": its CRS cannot be read, because PROJ cannot use its database (" +
                    plain_ascii(fault) + "): " +
                    (set.empty() ? "install proj-data, or set PROJ_LIB to the folder of proj.db"
                                 : "unset " + set + ", or name the folder of a proj.db of this PROJ"));
}

void require_known_crs(const OGRSpatialReference* crs, const std::string& name, const GdalErrors& errors,
                       const std::string& remedy) {
  require_crs_database(name);
  if (errors.unknown_crs())
    throw FormatError(name + ": the code of its CRS is not in PROJ's database: " + remedy, "crs");
  if (crs != nullptr && is_vertical_only(*crs))
    throw FormatError(name + ": its CRS, " + crs->GetName() + ", is one of heights alone: " + remedy, "crs");
}

}  // namespace landfall
