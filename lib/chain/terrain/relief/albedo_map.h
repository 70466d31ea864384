// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

#include "base/raster/grid.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The albedo of a terrain's nodes, which is loaded in tiles where points need it. From any thread.
class AlbedoMap final : public SurfaceAlbedo {
 public:
  /// Loads the nodes of a window. One call at a time, from any thread.
  using Load = std::function<Grid<float>(const GridSpec& window)>;

  /// Tiles have `tile` rows and columns, fewer at the northern and eastern border.
  AlbedoMap(const GridSpec& spec, const BinIndex& tile, Load load);

  /// The albedo of the node nearest to a point; NaN off the terrain. Throws as the loader does.
  [[nodiscard]] double at(double x_m, double y_m) const override;

 private:
  [[nodiscard]] const Grid<float>& tile(const BinIndex& number) const;

  GridSpec spec_;
  BinIndex tile_;
  std::int64_t tiles_per_row_;
  Load load_;
  mutable std::mutex loading_;
  mutable std::deque<Grid<float>> loaded_;
  mutable std::vector<std::atomic<const Grid<float>*>> tiles_;  ///< by number; null: not loaded
};

}  // namespace landfall
