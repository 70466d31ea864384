// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "chain/terrain/relief/site_mapping.h"

namespace landfall {

/// The extent of points on a body, radians: longitudes eastwards from `low` to `high`, which may lie beyond a
/// whole turn.
struct GeodeticExtent {
  LonLat low, high;
  [[nodiscard]] LonLat middle() const {
    return {low.lon_rad / 2 + high.lon_rad / 2, low.lat_rad / 2 + high.lat_rad / 2};
  }
};

/// Finds out whether points lie on both sides of the seam of their longitudes: where the widest gap between
/// them is another one than that around the seam, they lie across it. Bounded memory; the order of the points
/// does not matter. Gaps below 0.1 degrees may be missed: such points surround the body.
class GeodeticExtentSearch {
 public:
  void add(const LonLat& lon_lat);
  /// The extent of the points across the seam; none where their longitudes, as they are written, have no
  /// wider gap.
  [[nodiscard]] std::optional<GeodeticExtent> across_seam() const;

 private:
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    void add(double value);
    [[nodiscard]] bool empty() const { return low > high; }
  };

  static constexpr std::size_t kSectors = 4096;
  std::vector<Range> sectors_{kSectors};  ///< longitudes in [0, 2 pi)
  Range lon_, lat_;                       ///< as written
};

}  // namespace landfall
