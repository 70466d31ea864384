// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>

#include "base/raster/region.h"
#include "chain/draws/device_gridder.h"
#include "chain/draws/draw_maps.h"
#include "chain/evaluation/judge/verdict.h"
#include "chain/gridding/layers.h"
#include "chain/terrain/relief/triangulated_grid.h"

namespace landfall {

/// Judges draws on the device that makes them, bit for bit as decide() does, and keeps the sums of their maps
/// there. One byte per bin comes back for each draw; the CPU finds the holes among these. The device keeps 8
/// bytes per node of the terrain and 67 per bin, with maps 159.
class DeviceJudge {
 public:
  /// `gridder`, `terrain`, `region` and `map_truth` must outlive this object; without maps `map_truth` is
  /// null (DrawRunner::map_truth()).
  DeviceJudge(DeviceGridder& gridder, const TriangulatedGrid& terrain, const BinMask& region,
              const Grid<double>* map_truth);

  /// Makes and judges a draw, and adds it to the maps. Returns nothing, having added nothing, where the CPU
  /// is to make or to judge it: footprints of more than 257 bins on a side, errors that are infinite or
  /// beyond
  /// +-65,536 m, or an absolute error within rounding of its limit. Throws as DeviceGridder::draw() does.
  [[nodiscard]] std::optional<DecisiveMetrics> judge(const Simulation& simulation, Method method,
                                                     TruthAt truth_at,
                                                     const EvaluationParameters& parameters);

  /// Adds the maps of the draws since the last call to `maps`; `draws` is their number. Returns false, having
  /// added nothing, if the device lost them and the CPU takes over.
  [[nodiscard]] bool take_maps(std::int64_t draws, DrawMaps& maps);

 private:
  [[nodiscard]] DeviceJudged judged() const;

  DeviceGridder& gridder_;
  const TriangulatedGrid& terrain_;
  const BinMask& region_;
  const Grid<double>* map_truth_;
  BinMask valid_;  ///< of the last draw
  bool is_prepared_ = false;
};

}  // namespace landfall
