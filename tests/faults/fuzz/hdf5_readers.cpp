// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_readers.h"

#include <algorithm>
#include <optional>

#include "app/cli/description_text.h"
#include "app/exports/csv.h"
#include "app/exports/las.h"
#include "app/exports/quick_look.h"
#include "app/exports/sites.h"
#include "app/runs/draws_parts.h"
#include "app/runs/redraw.h"
#include "chain/evaluation/evaluate.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "landfall_files.h"
#include "store/config/uncertainty_config.h"
#include "store/files/draws_verdict.h"
#include "store/files/evaluation_file.h"
#include "store/files/file_description.h"
#include "store/files/hazard_file.h"
#include "store/files/range_file.h"
#include "store/files/scan_file.h"
#include "store/files/scan_gridding.h"
#include "store/files/table_reader.h"
#include "store/files/terrain_file.h"

namespace landfall::fuzz {
namespace {

using Path = std::filesystem::path;

/// Counts what it is given.
class NoSink final : public ByteSink {
 public:
  void write(std::string_view bytes) override { size_ += bytes.size(); }
  void finish() override {}

 private:
  std::size_t size_ = 0;
};

void describe(const Path& path) {
  for (const bool statistics : {false, true}) {
    const nlohmann::ordered_json description = describe_file(path, {.statistics = statistics});
    static_cast<void>(description.dump(2));
    static_cast<void>(cli::description_text(description));
    if (description.at("config").is_object()) static_cast<void>(cli::config_text(description));
  }
}

void read_terrain_file(const Path& path) {
  const TerrainInput terrain = read_terrain(path);
  static_cast<void>(terrain.surface->elevation(0.25, 0.5));
  static_cast<void>(terrain.chain.dump());
}

void read_large_terrain(const Path& path) {
  const std::optional<LargeTerrainInput> large = open_large_terrain(path, 4);
  if (large) static_cast<void>(large->terrain.load(large->terrain.spec));
}

void read_scan(const Path& path) {
  ScanReader scan(path);
  ScanPoints points;
  for (std::size_t begin = 0; begin < scan.row_count(); begin += kTableChunkRows)
    scan.read(begin, std::min(kTableChunkRows, scan.row_count() - begin), points);
  static_cast<void>(PoseTrack({read_scan_poses(scan)}));
}

void read_ranges(const Path& path) {
  RangeFile ranges(path);
  static_cast<void>(ranges.terrain());
  require_redraw(ranges, scan_provenance());
  static_cast<void>(has_rows_of(ranges, scan_provenance().config, false));
  static_cast<void>(ranges.read({0, 3}, 4));
}

/// Reads the parts of a scan's history that regrid --uncertainty takes.
void read_origin(const Path& path) {
  const LandfallFileReader file(path, {"scan"});
  const nlohmann::json none = nlohmann::json::object();
  static_cast<void>(uncertainty_parameters(none, "regrid.json", {{file.name(), file.config()}}));
}

void export_points(const Path& path) {
  const PointReader points(path);
  NoSink sink;
  std::vector<std::string> names;
  for (const ContentInfo& column : points.columns()) names.push_back(column.name);
  write_points_csv(points, {names, {false, 2}}, sink);
  static_cast<void>(write_points_las(points, {.software = "fuzz"}, sink));
}

void judge_dem(const Path& path) {
  DemInput dem = read_dem(path);
  const GridSpec spec = dem.layers.z_est.spec();
  const DemWindowReader windows(path);
  static_cast<void>(windows.read(spec));
  static_cast<void>(windows.count());
  static_cast<void>(read_uncertainty(path));
  static_cast<void>(read_region_mask(path, "z_est", {"map", spec, kLocalSiteCrsWkt}));
}

void export_grid(const Path& path) {
  const GridSource grid(path);
  NoSink sink;
  write_layers_csv(grid.read(grid.choose({"all"})), 1, sink);
}

/// Reads the layers of a DEM or a terrain that hazard-map takes.
void read_hazards_of(const Path& path) {
  static_cast<void>(read_hazard_source(path, true));
  static_cast<void>(read_truth_centroids(path));
}

void export_sites(const Path& path) {
  NoSink sink;
  write_sites_csv(LandfallFileReader(path, {"hazards"}), sink);
}

/// Reads the contents of a part that monte-carlo merge takes.
void merge_part(const Path& path) {
  Provenance provenance;
  MergedDraws merged = merge_draws({path.string()}, provenance);
  static_cast<void>(verdict_json(merged.draws.table, std::nullopt));
  if (!merged.draws.maps) return;
  DrawMaps& maps = *merged.draws.maps;
  maps.merge(DrawMaps(maps));
  for (std::size_t bin = 0; bin < maps.spec().size(); ++bin)
    static_cast<void>(maps.e_z.std_m(bin) + (maps.e_map ? maps.e_map->mean_m(bin) : 0));
}

void draw(const Path& path) { static_cast<void>(quick_look(path, "")); }

void read_table(const Path& path) {
  static_cast<void>(trajectory_samples(read_number_table(path, trajectory_columns())));
}

}  // namespace

std::vector<Hdf5Reader> readers_of(const std::string& kind) {
  if (kind == "terrain" || kind == "mesh")
    return {describe, read_terrain_file, read_large_terrain, export_grid, draw};
  if (kind == "scan") return {describe, read_scan, read_ranges, read_origin, export_points, draw};
  if (kind == "table") return {read_table};
  if (kind == "dem") return {describe, judge_dem, export_grid, draw, read_hazards_of};
  if (kind == "hazards") return {describe, export_grid, draw, export_sites};
  if (kind == "draws") return {describe, export_grid, draw, merge_part};
  return {describe, export_grid, draw};
}

}  // namespace landfall::fuzz
