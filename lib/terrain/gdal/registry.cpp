// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/registry.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>

#include <algorithm>
#include <mutex>
#include <span>
#include <string>
#include <vector>

namespace landfall {
namespace {

constexpr GIntBig kBlockCacheBytes = GIntBig{64} << 20U;

/// docs/user/terrain-gen.md lists them.
constexpr const char* kRasterDrivers[] = {
    "GTiff",  "AAIGrid",     "GRASSASCIIGrid", "AIG",     "EHdr",    "ENVI", "HFA",
    "netCDF", "HDF5",        "HDF5Image",      "BAG",     "PDS",     "PDS4", "ISIS2",
    "ISIS3",  "VICAR",       "DTED",           "SRTMHGT", "USGSDEM", "XYZ",  "PNG",
    "JPEG",   "JP2OpenJPEG", "GSAG",           "GSBG",    "GS7BG",   "SAGA", "RST",
    "ERS",    "Terragen",    "GRIB",           "GPKG",    "NITF",    "VRT",  nullptr};

/// docs/user/dem-eval.md lists them.
constexpr const char* kPolygonDrivers[] = {"GeoJSON", "GeoJSONSeq", "TopoJSON", "ESRI Shapefile",
                                           "GPKG",    "FlatGeobuf", "KML",      "MapInfo File",
                                           nullptr};

/// The drivers among them whose libraries open files without the guard (file_guard.h).
constexpr const char* kUnguardedDrivers[] = {"netCDF", "HDF5", "HDF5Image", "BAG"};

bool names_network(const std::string& path) {
  return path.find("/vsi") != std::string::npos || path.find("://") != std::string::npos;
}

bool contains(std::span<const char* const> names, const std::string& name) {
  return std::ranges::any_of(names, [&](const char* entry) { return entry != nullptr && name == entry; });
}

/// GDAL's drivers, some of which are offered. None is ever deleted because open rasters point to theirs.
class Drivers {
 public:
  Drivers() {
    GDALAllRegister();
    for (int i = 0; i < manager_.GetDriverCount(); ++i) all_.push_back(manager_.GetDriver(i));
  }
  template <class Wanted>
  void offer(const Wanted& wanted) {
    for (GDALDriver* const driver : all_) {
      const char* const name = driver->GetDescription();
      GDALDriver* const offered = manager_.GetDriverByName(name);
      if (wanted(name) && offered == nullptr) manager_.RegisterDriver(driver);
      if (!wanted(name) && offered != nullptr) manager_.DeregisterDriver(offered);
    }
  }

  [[nodiscard]] std::string unread_format(const std::string& path) const {
    GDALOpenInfo info(path.c_str(), GA_ReadOnly);
    for (GDALDriver* const driver : all_) {
      const bool is_unread = driver->GetMetadataItem(GDAL_DCAP_RASTER) != nullptr &&
                             !contains(kRasterDrivers, driver->GetDescription());
      if (is_unread && driver->pfnIdentify != nullptr && driver->pfnIdentify(&info) == TRUE) {
        const char* const name = driver->GetMetadataItem(GDAL_DMD_LONGNAME);
        return driver->GetDescription() + (name != nullptr ? " (" + std::string(name) + ")" : "");
      }
    }
    return "";
  }

 private:
  GDALDriverManager& manager_ = *GetGDALDriverManager();
  std::vector<GDALDriver*> all_;
};

/// Created before anything else and kept until the process ends, because its drivers are.
Drivers& drivers() {
  static auto* const drivers = [] {
    CPLSetErrorHandler(CPLQuietErrorHandler);  // for threads that GDAL starts itself
    GDALSetCacheMax64(kBlockCacheBytes);
    OSRSetPROJEnableNetwork(FALSE);  // whatever PROJ_NETWORK says: no other machine is called
    return new Drivers;
  }();
  return *drivers;
}

std::mutex& registry_lock() {
  static std::mutex lock;
  return lock;
}

}  // namespace

void prepare_gdal_to_read(const std::string& path, Unguarded unguarded) {
  const std::lock_guard guard(registry_lock());
  drivers().offer([&](const char* name) {
    return contains(kRasterDrivers, name) &&
           (unguarded == Unguarded::offered || !contains(kUnguardedDrivers, name));
  });
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", names_network(path) ? nullptr : "none");
}

void prepare_gdal_to_read_polygons() {
  const std::lock_guard guard(registry_lock());
  drivers().offer([](const char* name) { return contains(kPolygonDrivers, name); });
  CPLSetConfigOption("CPL_VSIL_CURL_ALLOWED_FILENAME", "none");
}

void prepare_gdal_to_write() {
  const std::lock_guard guard(registry_lock());
  drivers().offer([](const char*) { return true; });
}

std::string unread_format(const std::string& path) {
  const std::lock_guard guard(registry_lock());
  return drivers().unread_format(path);
}

const char* const* polygon_drivers() { return kPolygonDrivers; }

const char* const* raster_drivers() { return kRasterDrivers; }

}  // namespace landfall
