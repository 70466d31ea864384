// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/runs/scene.h"
#include "base/memory/large_memory.h"
#include "chain/draws/draw_runner.h"
#include "store/config/dem_config.h"
#include "store/config/draws_config.h"
#include "store/config/terrain_config.h"
#include "store/files/draws_file.h"
#include "store/files/meeting.h"
#include "store/files/range_file.h"

namespace landfall {

/// The true ranges of a scan, in memory: one for each pixel and pulse.
struct DrawsTruth {
  std::vector<double, LargeAllocator<double>> ranges_m;
  std::vector<Echo, LargeAllocator<Echo>> echoes;  ///< empty unless the scan keeps them
  std::vector<LaterEcho> later;                    ///< those behind the first of a pixel, ordered
};

/// The draws first .. end - 1.
struct DrawSpan {
  std::int64_t first = 0;
  std::int64_t end = 0;
};

/// Makes a terrain in memory, as make_terrain() in app/exports/terrain_output.h does.
using TerrainMaker = std::function<TerrainInput(const TerrainConfig&, Provenance&,
                                                const std::function<void(const std::string&)>& warn)>;

/// The ground of a run of draws; that of a traced scan is a file.
struct TerrainSource {
  std::string terrain;  ///< terrain.h5; empty: the section terrain of the run of draws
  TerrainMaker make;    ///< for the section
  std::function<void(const std::string&)> warn;
  MeetingRules rules = {};  ///< of regions
};

/// A run of draws over one traced scan, or one whose draws trace: its inputs in memory, and its draws.
class DrawSeries {
 public:
  /// Draws that trace. Reads or makes the ground, and adds it and the tables of the scan to the inputs of
  /// `provenance`. Throws UsageError, naming draw and key, unless the configuration of each draw of `span` is
  /// valid; FormatError as the readers do.
  DrawSeries(TerrainSource terrain, const DrawsConfig& config, const DrawSpan& span, Provenance& provenance);

  /// `pair` is the number of the scan in a run of draws over several: its draws follow those of the scans
  /// before, and their rows have it as the column kPairColumn. Reads the true ranges (8 bytes per ray) and
  /// the terrain, and adds both to the inputs of `provenance`. Throws UsageError, naming the key, unless
  /// every draw of `span` has the rays of the scan, and can be made by `device` if one is given
  /// (DeviceGridder); FormatError as the readers do, or for a terrain other than the one that was scanned.
  DrawSeries(const RangeFile& scan, TerrainSource terrain, const DrawsConfig& config, const DrawSpan& span,
             std::optional<std::int64_t> pair, const std::optional<OpenClOptions>& device,
             Provenance& provenance, const ProgressCallback& progress);

  [[nodiscard]] const std::string& crs_wkt() const { return scene_.crs_wkt; }
  /// No draw yet, from row `first` on.
  [[nodiscard]] Draws empty(std::int64_t first) const;
  /// Runs the draw after the last row of `draws`, and adds it. The result of each draw depends on its number
  /// only.
  void run_next(Draws& draws);
  /// Adds the remaining results of a device to the maps. Call after the last draw and before keeping `draws`.
  void complete(Draws& draws);

 private:
  /// Reads the judged region and makes the runner; `terrain` is that of all draws, null where it varies.
  [[nodiscard]] std::optional<BinMask> hazard_region(Provenance& provenance) const;
  void prepare(const TerrainSurface* terrain, const std::optional<OpenClOptions>& device,
               Provenance& provenance);
  void require_device(const DrawSpan& span) const;
  void open_terrain(bool uses_albedo, Provenance& provenance);
  void build_terrain(const nlohmann::json& terrain, Provenance& provenance);
  [[nodiscard]] DrawTerrain terrain_of(const DrawStages& stages, std::int64_t draw);
  [[nodiscard]] DrawSetup setup_of(const DrawStages& stages, std::int64_t draw) const;
  [[nodiscard]] std::optional<LandingSetup> landing_setup(const nlohmann::json& scan,
                                                          std::int64_t draw) const;
  [[nodiscard]] DrawResult run(std::int64_t draw, Draws& draws);

  const DrawsConfig& config_;
  std::optional<std::int64_t> pair_;
  TerrainSource source_;
  Scene scene_;
  std::shared_ptr<const SurfaceAlbedo> albedo_;
  std::int64_t terrain_draw_ = -1;  ///< the draw whose ground the scene is, where it varies
  DrawsTruth truth_;
  RegridConfig regrid_;
  BinMask region_;
  std::unique_ptr<DrawRunner> runner_;
  std::optional<Grid<float>> z_sigma_abs_;
  std::vector<std::int64_t> on_device_;  ///< draws that the maps do not have yet
};

}  // namespace landfall
