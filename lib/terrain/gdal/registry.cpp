// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/registry.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal.h>

#include <mutex>

namespace landfall {
namespace {

constexpr GIntBig kBlockCacheBytes = GIntBig{64} << 20U;

/// Drivers that a small local file can send to another machine.
constexpr const char* kWebDrivers[] = {"WMS",      "WMTS",  "WCS",  "HTTP", "OGCAPI", "STACTA", "STACIT",
                                       "PLMOSAIC", "EEDAI", "EEDA", "DAAS", "RDA",    "NGW"};

bool names_network(const std::string& path) {
  return path.find("/vsi") != std::string::npos || path.find("://") != std::string::npos;
}

void remove_web_drivers() {
  for (const char* const name : kWebDrivers)
    if (GDALDriverH driver = GDALGetDriverByName(name); driver != nullptr) GDALDeregisterDriver(driver);
}

}  // namespace

void prepare_gdal(const std::string& path) {
  static std::mutex lock;
  static std::once_flag first;
  const std::lock_guard guard(lock);
  std::call_once(first, [] {
    CPLSetErrorHandler(CPLQuietErrorHandler);  // of threads that GDAL starts itself
    GDALSetCacheMax64(kBlockCacheBytes);
  });
  GDALAllRegister();  // brings back what is missing
  const bool allowed = names_network(path);
  if (!allowed) remove_web_drivers();
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", allowed ? nullptr : "none");
}

}  // namespace landfall
