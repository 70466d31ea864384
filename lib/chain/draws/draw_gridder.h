// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/raster/grid.h"
#include "chain/draws/device_gridder.h"
#include "chain/evaluation/dem_layers.h"
#include "chain/gridding/accumulator.h"
#include "chain/gridding/grid_points.h"
#include "chain/gridding/layers.h"
#include "chain/gridding/method.h"
#include "chain/lidar/simulation/simulation.h"
#include "chain/ray/engine.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The DEM of one draw, as regrid writes it and dem-eval reads it: the same bits.
struct DrawnDem {
  DemLayers layers;          ///< with truth
  Grid<std::int32_t> count;  ///< returns of each bin
};

/// The true terrain of a draw. What it points to outlives the draw.
struct DrawTerrain {
  const TerrainSurface& surface;
  const RayEngine* engine = nullptr;  ///< null: the draw takes the ranges of the traced scan
  const SurfaceAlbedo* albedo = nullptr;
  std::optional<double> spacing_m = std::nullopt;  ///< DemLayers::truth_spacing_m

  [[nodiscard]] Simulation simulate(ScanModel model) const {
    return {std::move(model), engine, &surface, albedo};
  }
};

/// Makes the returns of a draw and grids them, without files: scan-sim, or scan-sim --ranges-from, and regrid
/// in memory, by the same simulation and gridding. On all threads; the result does not depend on their
/// number. Memory besides the ranges: at most 2^17 points, and the sums of the method.
class DrawGridder {
 public:
  /// `truth` holds one range per pixel and pulse (RangeFile), and its echo if the receiver sees waveforms; it
  /// is empty for draws that trace. It must outlive this object. With `device`, an OpenCL device makes the
  /// draws, as DeviceGridder can.
  DrawGridder(const TrueRanges& truth, const GridSpec& grid,
              const std::optional<OpenClOptions>& device = std::nullopt);

  /// Null without a device.
  [[nodiscard]] DeviceGridder* device() const { return device_.get(); }

  /// Replaces `dem`, whose memory is used again, by the DEM of the draw. `simulation` must use the terrain
  /// `truth`. Without an engine its pulse and pixel counts must match the ranges; throws FormatError
  /// otherwise.
  void draw(const Simulation& simulation, Method method, TruthAt truth_at, const TerrainSurface& truth,
            DrawnDem& dem);

 private:
  [[nodiscard]] Accumulator& empty_bins(Method method);
  void fill(const Simulation& simulation, PulseSpan pulses);
  void fill_slots(const Simulation& simulation, PulseSpan pulses, std::size_t first_slot);
  /// All points of the batch, in order: those without an estimate are NaN, which reach no bin. Valid until
  /// the batch changes. The times are zeros: no layer of the DEM that is judged needs them.
  [[nodiscard]] GridPoints points();
  /// Fills the values of bins of the device, or of an Accumulator, from `first` on along its row.
  using ReadBins = std::function<void(BinIndex first, std::span<BinValues> out)>;
  void take_values(const ReadBins& read, TruthAt truth_at, const TerrainSurface& truth, DrawnDem& dem) const;

  TrueRanges truth_;
  GridSpec grid_;
  // Reused by all draws: the system clears fresh memory, which costs as much as gridding.
  PulseBatch batch_;
  std::vector<double> no_times_;
  std::unique_ptr<DeviceGridder> device_;
  std::unique_ptr<Accumulator> bins_;
  Method method_ = Method::bilinear_nearest;  ///< of the bins
  bool are_empty_ = false;                    ///< the bins, after a draw that took their values
};

}  // namespace landfall
