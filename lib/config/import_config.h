// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "config/json_source.h"
#include "terrain/relief/site_fit.h"
#include "terrain/terrain_model.h"

namespace landfall {

/// The command line's short way to import a raster, as texts; empty is not given. Each stands for a key of
/// the terrain configuration: half_width and resolution for those of /grid, the others for those of /base.
/// Where is_mesh_name(from), it stands for /mesh/path instead, and no other may be given.
struct ImportOptions {
  std::string from;          ///< path
  std::string center;        ///< "x,y"
  std::string center_pixel;  ///< "column,row"
  std::string band;
  std::string interpolation;
  std::string datum;
  std::string vertical_scale;
  std::string horizontal_scale;
  std::string half_width;
  std::string resolution;
  friend bool operator==(const ImportOptions&, const ImportOptions&) = default;
};

/// Writes the options, UTF-8, into a configuration as a file would have them, so that the same run has the
/// same resolved configuration either way. Throws UsageError naming the option where a text is no number or
/// no pair of numbers, and naming both where the configuration has a base of its own.
void apply_import(JsonSource& source, const ImportOptions& options);

/// For --from with a terrain.h5, which is exported as it is: throws UsageError where the run is `configured`
/// or another of the options is given.
void require_plain_export(const ImportOptions& options, bool configured);

/// What a raster gives for the parts of a site's grid that are open: fit_dem_site() of
/// terrain/gdal/gdal_loader.h.
using SiteFitter = std::function<SiteSize(const DemBase& dem, const SiteRequest& request)>;

/// Fills in half width and resolution from the raster of --from where the configuration, with its
/// assignments, leaves them open. Throws UsageError where an assignment replaced the base, and
/// what `fit` throws.
void complete_import(JsonSource& source, const ImportOptions& options, const SiteFitter& fit);

}  // namespace landfall
