// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D449
#include "formats/gdal/registry.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <cpl_vsi.h>
#include <gdal_priv.h>
#include <ogr_srs_api.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
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

/// The beginnings of the variables that GDAL may read: folders of data and of temporary files, access to a
/// network that the path of a raster names, and checks that a user switches off. None changes a number.
constexpr std::string_view kPassedVariables[] = {"GDAL_DATA=",
                                                 "GDAL_DRIVER_PATH=",
                                                 "HOME=",
                                                 "TMPDIR=",
                                                 "CPL_TMPDIR=",
                                                 "DTED_VERIFY_CHECKSUM=",
                                                 "GDAL_ERROR_ON_LIBJPEG_WARNING=",
                                                 "AWS_",
                                                 "AZURE_",
                                                 "CPL_AWS_",
                                                 "CPL_AZURE_",
                                                 "CPL_CURL_",
                                                 "CPL_GCE_",
                                                 "CPL_GS_",
                                                 "CPL_VSIL_CURL_",
                                                 "CURL_CA_BUNDLE=",
                                                 "GDAL_CURL_",
                                                 "GDAL_HTTP_",
                                                 "GOOGLE_",
                                                 "GS_",
                                                 "OSS_",
                                                 "OS_",
                                                 "SSL_CERT_FILE=",
                                                 "SWIFT_",
                                                 "WEBHDFS_"};

/// A configuration file of GDAL's.
constexpr const char* kOptionsFile = "/vsimem/landfall-gdalrc";
constexpr std::string_view kOptions = "[directives]\nignore-env-vars=yes\n";

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

void ignore_gdal_options() {
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text = *variable;
    const auto begins = [&](std::string_view beginning) { return text.starts_with(beginning); };
    if (const auto end = text.find('='); std::ranges::any_of(kPassedVariables, begins))
      CPLSetConfigOption(std::string(text.substr(0, end)).c_str(), *variable + end + 1);
  }
  VSILFILE* const file = VSIFOpenL(kOptionsFile, "wb");
  VSIFWriteL(kOptions.data(), 1, kOptions.size(), file);
  VSIFCloseL(file);
  CPLSetConfigOption("GDAL_CONFIG_FILE", kOptionsFile);  // instead of those of the system and of the user
  // GDAL 3.6 would look it up again and again to say that it ignores it, until the stack ends.
  unsetenv("CPL_DEBUG");  // NOLINT(concurrency-mt-unsafe): once, at the first use of GDAL
  CPLLoadConfigOptionsFromFile(kOptionsFile, FALSE);
}

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
