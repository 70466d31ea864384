// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "terrain/relief/dem_raster.h"

namespace landfall {

/// The grid of a site, as far as it is given; metres.
struct SiteRequest {
  std::optional<double> half_width_m;
  std::optional<double> resolution_m;
};

struct SiteSize {
  double half_width_m = 0;
  double resolution_m = 0;
  friend bool operator==(const SiteSize&, const SiteSize&) = default;
};

/// A raster as a site meets it.
struct SiteRaster {
  const SiteMapping& mapping;
  RasterSize size;
  double posting_m = 0;  ///< the distance of its pixels
};

/// Completes a request. The resolution is the raster's posting, made finer by as little as it takes to divide
/// a half width that is given; the half width the largest multiple of the resolution whose square lies inside
/// the raster.
///
/// The message begins with `what`. Throws UsageError where a default half width would make more than
/// 2^26 nodes, FormatError where not one cell fits around the centre.
[[nodiscard]] SiteSize fit_site(const SiteRaster& raster, Interpolation method, const SiteRequest& request,
                                const std::string& what);

}  // namespace landfall
