// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "app/runs/scene.h"
#include "base/memory/large_memory.h"
#include "base/memory/used_memory.h"
#include "chain/draws/draw_lanes.h"
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

/// Questions of a run of draws to its owner, and its news.
struct DrawsControl {
  std::function<bool()> begins;  ///< whether another draw may begin; any thread calls it
  std::function<bool()> added;   ///< called after each draw, in order: whether the next one is added, too
  std::function<void(const std::string&)> log;
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

  [[nodiscard]] const std::string& crs_wkt() const { return crs_wkt_; }
  /// No draw yet, from row `first` on.
  [[nodiscard]] Draws empty(std::int64_t first) const;
  /// Runs the `count` draws after the last row of `draws`, and adds them in order. The result of each draw
  /// depends on its number only. The first one has all threads, and shows how many fit into the memory at a
  /// time; a device makes one at a time.
  void run(Draws& draws, std::int64_t count, const DrawsControl& control);
  /// Adds the remaining results of a device to the maps. Call after the last draw and before keeping `draws`.
  void complete(Draws& draws);

 private:
  struct Terrain {
    Scene scene;
    std::shared_ptr<const SurfaceAlbedo> albedo;
    std::int64_t draw = -1;  ///< whose terrain it is, where it varies
  };
  /// The memory of a draw until it is added.
  struct Lane {
    Lane(Terrain& lane_terrain, const DrawsScene& scene, const std::optional<OpenClOptions>& device)
        : terrain(lane_terrain), runner(scene, device) {}
    Terrain& terrain;
    DrawRunner runner;
    DrawnLayers layers;
    DrawResult result;
  };

  /// Reads the judged region and makes the first lane; `terrain` is that of all draws, null where it varies.
  [[nodiscard]] std::optional<BinMask> hazard_region(Provenance& provenance) const;
  void prepare(const TerrainSurface* terrain, const std::optional<OpenClOptions>& device,
               Provenance& provenance);
  void require_device(const DrawSpan& span) const;
  void open_terrain(SceneUse use, bool uses_albedo, Provenance& provenance);
  void build_terrain(const nlohmann::json& config, Terrain& terrain, Provenance& provenance) const;
  [[nodiscard]] DrawTerrain terrain_of(const DrawStages& stages, std::int64_t draw, Terrain& terrain) const;
  [[nodiscard]] DrawSetup setup_of(const DrawStages& stages, std::int64_t draw) const;
  [[nodiscard]] std::optional<LandingSetup> landing_setup(const nlohmann::json& scan,
                                                          std::int64_t draw) const;
  bool run_on_lanes(Draws& draws, std::int64_t count, const DrawsControl& control);
  void choose_lanes(const UsedMemory& before, const DrawsControl& control);
  void make(std::int64_t draw, Lane& lane) const;
  void add_to_maps(std::int64_t draw, const Lane& lane, DrawMaps& maps) const;
  void add(std::int64_t draw, const Lane& lane, Draws& draws);

  const DrawsConfig& config_;
  std::optional<std::int64_t> pair_;
  TerrainSource source_;
  std::deque<Terrain> terrains_{1};  ///< that of all draws, or one for each lane
  std::string crs_wkt_;
  std::uint64_t terrain_bytes_ = 0;  ///< of a terrain that varies, while it is made
  DrawsTruth truth_;
  RegridConfig regrid_;
  std::optional<DrawsScene> scene_;
  DrawLanes shape_;
  bool is_shaped_ = false;
  std::deque<Lane> lanes_;
  std::optional<Grid<float>> predicted_sigma_;
  std::vector<std::int64_t> on_device_;  ///< draws that the maps do not have yet
};

}  // namespace landfall
