// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/gdal_loader.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/headroom.h"
#include "base/parallel.h"
#include "base/thread_supply.h"
#include "terrain/gdal/plugin.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> plugin_folders() {
  std::vector<fs::path> folders;
  // getenv is safe here because the program never changes the environment.
  if (const char* chosen = std::getenv("LANDFALL_PLUGIN_DIR");  // NOLINT(concurrency-mt-unsafe)
      chosen != nullptr && *chosen != '\0')
    folders.emplace_back(chosen);
  std::error_code unreadable;
  const fs::path program = fs::read_symlink("/proc/self/exe", unreadable);
  if (!unreadable) {
    const fs::path prefix = program.parent_path().parent_path();
    folders.push_back(prefix / "lib" / "landfall");
    folders.push_back(prefix / LANDFALL_LIBDIR / "landfall");
  }
  folders.emplace_back(LANDFALL_PLUGIN_INSTALL_DIR);
  for (auto folder = folders.begin(); folder != folders.end();)
    folder = std::find(folders.begin(), folder, *folder) == folder ? folder + 1 : folders.erase(folder);
  return folders;
}

/// GDAL, its hundred libraries and their initialisation; some of them crash with less memory.
constexpr std::size_t kHeadroomOfGdal = std::size_t{192} << 20U;

std::string last_dl_error() {
  const char* reason = dlerror();  // NOLINT(concurrency-mt-unsafe): glibc has one for each thread
  return reason != nullptr ? reason : "unknown reason";
}

const GdalPlugin& plugin_at(const fs::path& file) {
  require_headroom(kHeadroomOfGdal);
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw IoError("cannot load the GDAL plugin: " + last_dl_error());
  const auto* plugin = static_cast<const GdalPlugin*>(dlsym(library, kGdalPluginSymbol));
  if (plugin == nullptr) throw IoError("cannot use the GDAL plugin: " + last_dl_error());
  if (std::string(plugin->version) != LANDFALL_VERSION)
    throw IoError(file.string() + ": is of version " + plugin->version +
                  ", this program of " LANDFALL_VERSION);
  return *plugin;
}

const GdalPlugin& find_plugin() {
  std::string tried;
  for (const fs::path& folder : plugin_folders()) {
    const fs::path file = folder / "landfall-gdal.so";
    std::error_code missing;
    if (fs::exists(file, missing)) return plugin_at(file);
    tried += (tried.empty() ? "" : ", ") + file.string();
  }
  throw IoError("rasters need the plugin landfall-gdal.so, which a complete installation has; it is not at " +
                tried + "; install it, or set LANDFALL_PLUGIN_DIR to its directory");
}

/// Never unloaded because GDAL keeps pointers into it. The next call repeats a search that failed.
const GdalPlugin& plugin() {
  static const GdalPlugin& found = find_plugin();
  return found;
}

/// Without the plugin the raster cannot be read; the message must not blame the output of the run.
const GdalPlugin& plugin_for(const DemBase& dem) {
  try {
    return plugin();
  } catch (const IoError& error) {
    throw FormatError(dem.path + ": " + error.what());
  }
}

}  // namespace

DemRaster load_dem(const DemBase& dem, const GridSpec& site) {
  return plugin_for(dem).read_dem(dem, site, RasterLinks::refused);
}

DemLoader dem_loader(RasterLinks links) {
  return [links](const DemBase& dem, const GridSpec& site) {
    return plugin_for(dem).read_dem(dem, site, links);
  };
}

SiteSize fit_dem_site(const DemBase& dem, const SiteRequest& request, RasterLinks links) {
  return plugin_for(dem).fit_dem_site(dem, request, links);
}

std::vector<std::string> named_dem_files(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).named_files(dem.path, links);
}

std::vector<std::string> dem_files(const DemBase& dem, RasterLinks links) {
  return plugin_for(dem).dem_files(dem, links);
}

void write_geotiff(const OutputOptions& options, const GeotiffContent& content,
                   const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  plugin().write_geotiff(output.temporary().string(), content,
                         {options.compression, thread_supply(thread_count())}, progress);
  output.commit();
}

void write_geopackage(const OutputOptions& options, const PointLayer& layer) {
  OutputPath output(options.path, options.overwrite);
  plugin().write_geopackage_points(output.temporary().string(), layer);
  output.commit();
}

}  // namespace landfall
