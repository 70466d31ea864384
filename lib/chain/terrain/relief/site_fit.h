// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "chain/terrain/relief/dem_raster.h"

namespace landfall {

/// The requested grid of a site; metres. Missing values are derived from the raster.
struct SiteRequest {
  std::optional<double> half_width_m;
  std::optional<double> resolution_m;
};

struct SiteSize {
  double half_width_m = 0;
  double resolution_m = 0;
  friend bool operator==(const SiteSize&, const SiteSize&) = default;
};

/// The mapping of a site to a raster, and the raster's properties.
struct SiteRaster {
  const SiteMapping& mapping;
  RasterSize size;
  double posting_m = 0;  ///< the pixel spacing
};

/// Completes a request. The default resolution is the raster's posting, reduced by as little as needed to
/// divide a given half width; the default half width is the largest multiple of the resolution whose square
/// lies inside the raster.
///
/// The message begins with `what`. Throws UsageError if a default half width would give more than 2^26 nodes,
/// FormatError if not even one cell fits around the centre.
[[nodiscard]] SiteSize fit_site(const SiteRaster& raster, Interpolation method, const SiteRequest& request,
                                const std::string& what);

}  // namespace landfall
