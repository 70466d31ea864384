// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/relief/site_fit.h"

#include <cmath>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::int64_t kHalfLimit = 4095;    // 8191 x 8191 nodes < 2^26
constexpr double kMultipleTolerance = 1e-9;  // of a multiple, as in GridSpec::centered()

double dividing(double half_width_m, double posting_m) {
  const double steps = half_width_m / posting_m;
  const double whole = std::round(steps);
  if (whole >= 1 && std::abs(steps - whole) <= kMultipleTolerance) return posting_m;
  return half_width_m / std::ceil(steps);
}

double largest_half_width(const SiteRaster& raster, Interpolation method, double resolution_m,
                          const std::string& what) {
  // Searching up to one node beyond the limit shows whether the limit is exceeded.
  const std::int64_t half = largest_half(raster.mapping, raster.size, method, resolution_m, kHalfLimit + 1);
  if (half < 1)
    throw FormatError(what + ": not one cell of " + number_text(resolution_m) +
                      " m fits around the centre: give another center or a finer resolution");
  if (half > kHalfLimit)
    throw UsageError(what + ": the whole raster at " + number_text(resolution_m) +
                         " m would have more than 2^26 nodes; give half_width_m",
                     "half_width_m");
  return static_cast<double>(half) * resolution_m;
}

}  // namespace

SiteSize fit_site(const SiteRaster& raster, Interpolation method, const SiteRequest& request,
                  const std::string& what) {
  SiteSize size;
  size.resolution_m = request.resolution_m   ? *request.resolution_m
                      : request.half_width_m ? dividing(*request.half_width_m, raster.posting_m)
                                             : raster.posting_m;
  size.half_width_m = request.half_width_m ? *request.half_width_m
                                           : largest_half_width(raster, method, size.resolution_m, what);
  return size;
}

}  // namespace landfall
