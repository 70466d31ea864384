// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D1, D2, D401
#include "base/raster/grid_spec.h"

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::int64_t kMaxValues = std::int64_t{1} << 30U;

/// The bin on a coordinate of the centre.
std::int64_t centre_bin(double center_m, double resolution_m, const std::string& what) {
  const double ratio = center_m / resolution_m;
  const double bin = std::nearbyint(ratio);
  if (!(std::abs(bin) <= 0x1p40) || std::abs(ratio - bin) > 1e-9)
    throw UsageError(what + ": center_m " + number_text(center_m) +
                     " is not a whole multiple (up to 2^40) of resolution_m " + number_text(resolution_m));
  return static_cast<std::int64_t>(bin);
}

/// The bins on either side of the centre.
std::int64_t half_bins(double half_width_m, double resolution_m, const std::string& what) {
  const double ratio = half_width_m / resolution_m;
  const double half = std::nearbyint(ratio);
  if (!(half >= 1 && half <= 0x1p28) || std::abs(ratio - half) > 1e-9)
    throw UsageError(what + ": half_width_m " + number_text(half_width_m) +
                     " is not a whole multiple (1 to 2^28) of resolution_m " + number_text(resolution_m));
  return static_cast<std::int64_t>(half);
}

}  // namespace

GridSpec GridSpec::centered(double half_width_m, double resolution_m, const char* what) {
  const auto refuse = [&](const std::string& reason) { throw UsageError(std::string(what) + ": " + reason); };
  if (!std::isfinite(resolution_m) || resolution_m <= 0)
    refuse("resolution_m " + number_text(resolution_m) + " is not finite and positive");
  const double ratio = half_width_m / resolution_m;
  const double half = std::nearbyint(ratio);
  if (!(half >= 1 && half <= 0x1p30) || std::abs(ratio - half) > 1e-9)
    refuse("half_width_m " + number_text(half_width_m) +
           " is not a whole multiple (1 to 2^30) of resolution_m " + number_text(resolution_m));
  const auto n = static_cast<std::int64_t>(half);
  if ((2 * n + 1) * (2 * n + 1) > kMaxValues)
    refuse("half_width_m " + number_text(half_width_m) + " at resolution_m " + number_text(resolution_m) +
           " makes " + std::to_string(2 * n + 1) + " x " + std::to_string(2 * n + 1) +
           " values, more than 2^30");
  return {resolution_m, -n, -n, 2 * n + 1, 2 * n + 1};
}

std::string size_text(const GridSpec& spec) {
  return grouped(spec.cols) + " x " + grouped(spec.rows) + " bins";
}

GridSpec grid_over(const GridArea& area, double resolution_m, const char* what) {
  const auto [width_x, width_y] = area.half_width_m;
  if (width_x == width_y && area.center_m == Horizontal{})
    return GridSpec::centered(width_x, resolution_m, what);
  const std::int64_t across = half_bins(width_x, resolution_m, what);
  const std::int64_t up = half_bins(width_y, resolution_m, what);
  const GridSpec grid{resolution_m, centre_bin(area.center_m.y, resolution_m, what) - up,
                      centre_bin(area.center_m.x, resolution_m, what) - across, 2 * up + 1, 2 * across + 1};
  if (grid.rows > kMaxValues / grid.cols)
    throw UsageError(std::string(what) + ": half_width_m " + number_text(width_x) + ", " +
                     number_text(width_y) + " at resolution_m " + number_text(resolution_m) + " makes " +
                     std::to_string(grid.rows) + " x " + std::to_string(grid.cols) +
                     " values, more than 2^30");
  return grid;
}

}  // namespace landfall
