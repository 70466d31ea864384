// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "chain/terrain/relief/site_fit.h"
#include "chain/terrain/terrain_model.h"
#include "store/config/json_source.h"

namespace landfall {

/// The command-line options to import a raster, as texts; empty if not given. Each sets a key of the terrain
/// configuration: half_width and resolution keys of /grid, up of /mesh, the others keys of /base. If
/// is_mesh_name(from), `from` sets /mesh/path instead, and no other option than up may be given.
struct ImportOptions {
  std::string from;          ///< path
  std::string center;        ///< "x,y"
  std::string center_pixel;  ///< "column,row"
  std::string band;
  std::string interpolation;
  std::string datum;
  std::string vertical_scale;
  std::string horizontal_scale;
  std::string crs;
  std::string nodata;  ///< numbers separated by commas, or "none"
  std::string half_width;
  std::string resolution;
  std::string up;  ///< "y" or "z"
  friend bool operator==(const ImportOptions&, const ImportOptions&) = default;
};

/// Writes the options, UTF-8, into a configuration as a file would contain them, so that the same run has the
/// same resolved configuration either way. Other keys of /base, or of /mesh, are merged over those of the
/// import. Throws UsageError naming the option if a text is not a number or not a pair of numbers, naming the
/// key if the configuration has another base or gives a key of the import too, and for up without a mesh.
void apply_import(JsonSource& source, const ImportOptions& options);

/// For --from with a terrain.h5, which is exported unchanged: throws UsageError if the run is `configured` or
/// another of the options is given.
void require_plain_export(const ImportOptions& options, bool configured);

/// Determines the parts of a site's grid that are not set from a raster: fit_dem_site() of
/// formats/gdal/gdal_loader.h.
using SiteFitter = std::function<SiteSize(const DemBase& dem, const SiteRequest& request)>;

/// Fills in half width and resolution from the raster of --from if the configuration and its
/// assignments do not set them. Throws UsageError if an assignment replaced the base, and as `fit`
/// does.
void complete_import(JsonSource& source, const ImportOptions& options, const SiteFitter& fit);

/// The section terrain that --from and --center, "X,Y" or empty, stand for. Throws as apply_import() does.
[[nodiscard]] nlohmann::json import_section(const std::string& from, const std::string& center);

/// Replaces from and center of the section /terrain by the base, or mesh, and the grid that terrain-gen
/// --from and --center give, merged with the rest of the section. Values of another type than the schema's
/// are left for it to refuse. Throws UsageError, naming the section, as apply_import() and complete_import()
/// do, and for a centre without a raster.
void import_terrain(JsonSource& config, const SiteFitter& fit);

}  // namespace landfall
