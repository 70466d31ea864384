// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D398
#include "app/runs/dem_output.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "app/runs/placed_scene.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "store/config/config_path.h"
#include "store/config/uncertainty_config.h"
#include "store/files/scan_gridding.h"

namespace landfall {
namespace {

/// The inputs of an uncertainty map, other than the bins.
struct UncertaintyInputs {
  UncertaintyParameters parameters;
  PoseTrack poses;
  std::string left_out;  ///< errors of the scans, comma-separated
};

/// The poses of a scan in the frame of the first scan.
ScanPoses placed_poses(const ScanReader& scan, const Placement& placement) {
  ScanPoses poses = read_scan_poses(scan);
  if (placement.is_reprojected())
    throw UsageError(
        "--uncertainty: " + scan.file().name() +
        " is in another map projection than the first scan, in which its attitudes are not known");
  const auto& [x_m, y_m, z_m] = placement.shift_m();
  for (Eigen::Vector3d& position : poses.position_m) position += Eigen::Vector3d(x_m, y_m, z_m);
  return poses;
}

UncertaintyInputs uncertainty_inputs(const Scans& scans, const std::vector<Placement>& placements,
                                     DemOutput& output) {
  std::vector<ScanOrigin> origins;
  std::vector<ScanPoses> poses;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    origins.push_back({scans[i]->file().name(), scans[i]->file().config()});
    poses.push_back(placed_poses(*scans[i], placements[i]));
  }
  nlohmann::json& config = output.provenance.config;
  const UncertaintyParameters parameters = uncertainty_parameters(config, output.config_name, origins);
  config["uncertainty"] = uncertainty_json(parameters);
  return at_path("--uncertainty: ", [&] {
    return UncertaintyInputs{parameters, PoseTrack(poses), joined(errors_left_out(parameters, origins))};
  });
}

std::vector<std::string> warnings_of(const UncertaintyInputs& inputs, const UncertaintyWords& words) {
  std::vector<std::string> warnings;
  if (inputs.parameters.range_sigma_m == 0)
    warnings.push_back(words.subject + "the range noise is 0; give " + words.range_sigma +
                       " if the lidar has noise");
  if (!inputs.left_out.empty())
    warnings.push_back(words.subject + "the sigmas leave out errors of the scans: " + inputs.left_out);
  return warnings;
}

/// floor(x/s + 0.5) of a point on an edge is decided by the rounding of x/s: a regular pattern on the edges
/// fills some bins twice and leaves others empty.
std::vector<std::string> edge_warnings(const Scans& scans, const std::vector<EdgeSample>& edges,
                                       double resolution_m) {
  constexpr std::int64_t kFewest = 20;
  constexpr double kShare = 0.05;
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double share = static_cast<double>(edges[i].on_edge) / static_cast<double>(edges[i].count);
    if (edges[i].count < kFewest || share <= kShare) continue;
    warnings.push_back(scans[i]->file().name() + ": " + percent_text(share) + " of its first " +
                       grouped(edges[i].count) + " returns lie on an edge between bins of " +
                       number_text(resolution_m) +
                       " m, where rounding decides the bin: move the pattern by half a bin, or change "
                       "--resolution");
  }
  return warnings;
}

/// The text at a path of a scan's configuration, which may have any structure in a foreign file.
std::string text_at(const nlohmann::json& config, const char* path, const char* otherwise) {
  const nlohmann::json::json_pointer where(path);
  const bool is_text = config.is_object() && config.contains(where) && config.at(where).is_string();
  return is_text ? config.at(where).get<std::string>() : otherwise;
}

std::string returns_used(const Scans& scans) {
  std::vector<std::string> all;
  for (const auto& scan : scans) {
    const nlohmann::json& config = scan->file().config();
    const bool has_receiver = text_at(config, "/receiver/type", "none") != "none";
    const std::string used = has_receiver ? text_at(config, "/receiver/returns", "first") : "one";
    if (std::ranges::find(all, used) == all.end()) all.push_back(used);
  }
  return joined(all);
}

/// The terrain of the true elevations; without one the scene has no surface.
Scene open_truth(const DemSources& sources, const Scans& scans, const GridSpec& grid, DemOutput& output,
                 std::vector<std::string>& warnings) {
  if (sources.terrain.empty()) return {};
  Scene truth;
  output.phase("terrain", [&](const ProgressCallback& progress) {
    truth = open_scene({.terrain = sources.terrain, .use = SceneUse::surface}, progress);
  });
  output.provenance.add_input("terrain", truth.file_id, truth.chain);
  if (!sources.rules.same_frame) require_scans_of(scans, truth, sources.terrain);
  const Meeting meeting = meet(meeting_kind("terrain_of_scans"), sited(*scans.front()),
                               {sources.terrain, truth.crs_wkt}, sources.rules);
  add_said(warnings, sources.terrain, meeting);
  require_window(truth, grid, meeting.placement);
  return placed_scene(std::move(truth), meeting.placement);
}

/// Computes the maps from which the corrected elevations and the sigmas are taken.
void compute_error_maps(GriddedScans& gridded, const std::optional<UncertaintyInputs>& inputs,
                        const PhaseRunner& phase) {
  phase("slope",
        [&](const ProgressCallback& progress) { gridded.slopes = slope_layer(*gridded.nearest, progress); });
  if (!inputs) return;
  phase("uncertainty", [&](const ProgressCallback& progress) {
    gridded.uncertainty = std::make_unique<UncertaintyMap>(*gridded.nearest, *gridded.moments, gridded.slopes,
                                                           inputs->poses, inputs->parameters, progress);
  });
}

/// A terrain without an elevation in any bin with a return is that of another place.
void require_truth(const Accumulator& bins, const TerrainSurface& truth, const std::string& terrain) {
  const GridSpec& grid = bins.spec();
  std::vector<BinValues> row(static_cast<std::size_t>(grid.cols));
  bool any_return = false;
  for (std::int64_t r = 0; r < grid.rows; ++r) {
    bins.values({r, 0}, row);
    for (std::int64_t c = 0; c < grid.cols; ++c) {
      if (row[static_cast<std::size_t>(c)].count == 0) continue;
      any_return = true;
      if (std::isfinite(truth.elevation(grid.x(c), grid.y(r)))) return;
    }
  }
  if (any_return)
    throw FormatError(terrain +
                      ": has no elevation at any bin with a return: is it the terrain of another place?");
}

/// Imported points have no poses and no true positions.
void require_possible(const Scans& scans, const RegridConfig& config, const DemRequest& layers) {
  const auto truths = std::ranges::count_if(scans, [](const auto& scan) { return scan->has_truth(); });
  if (truths > 0 && truths < std::ssize(scans))
    throw UsageError(
        "imported scans and scans of scan-sim cannot be gridded together: only the latter have "
        "true points");
  for (const auto& scan : scans) {
    if (scan->has_truth()) continue;
    const std::string& name = scan->file().name();
    if (layers.uncertainty)
      throw UsageError("--uncertainty: " + name + " is imported: it has no poses from which sigmas follow");
    if (config.truth_at == TruthAt::centroid)
      throw UsageError("truth_at centroid: " + name +
                       " is imported: it has no true positions; use bin_center");
  }
}

}  // namespace

BinnedReturns make_dem(const RegridConfig& config, const DemSources& sources, DemRequest layers,
                       DemOutput output) {
  const Scans scans = open_scans(sources.scans, output.provenance);
  require_possible(scans, config, layers);
  ScanPlacements placements = place_scans(scans, sources.rules);
  std::vector<std::string> warnings = std::move(placements.said);
  std::optional<UncertaintyInputs> uncertainty;
  if (layers.uncertainty) {
    uncertainty = uncertainty_inputs(scans, placements.of, output);
    for (std::string& warning : warnings_of(*uncertainty, uncertainty_words(output.config_name)))
      warnings.push_back(std::move(warning));
    if (!uncertainty->left_out.empty())
      layers.left_out = "leaves out errors of the scans: " + uncertainty->left_out;
  }
  const Scene truth = open_truth(sources, scans, config.grid, output, warnings);
  layers.epoch_s = scans.front()->epoch_s();
  layers.true_points = std::ranges::all_of(scans, [](const auto& scan) { return scan->has_truth(); });
  layers.times = std::ranges::all_of(scans, [](const auto& scan) { return scan->has_times(); });
  layers.truth = truth.surface.get();
  layers.truth_spacing_m = truth.spacing_m;
  layers.truth_at = config.truth_at;
  check_layers(layers);
  LandfallFileWriter file(output.file, "dem", output.provenance);
  GriddedScans gridded;
  output.phase("grid", [&](const ProgressCallback& progress) {
    gridded = grid_scans(scans, {config.grid, config.method, layers.uncertainty, std::move(placements.of)},
                         progress);
  });
  if (gridded.without_place > 0 && gridded.bins->inside_count() + gridded.bins->outside_count() == 0)
    throw FormatError("no return of the scans has a place in the site frame of " +
                      scans.front()->file().name());
  if (truth.surface) require_truth(*gridded.bins, *truth.surface, sources.terrain);
  if (gridded.without_place > 0)
    warnings.push_back(grouped(gridded.without_place) + " returns have no place in the site frame of " +
                       scans.front()->file().name() + " (beyond its horizon) and are left out");
  for (std::string& warning : edge_warnings(scans, gridded.edges, config.grid.resolution_m))
    warnings.push_back(std::move(warning));
  if (layers.uncertainty || layers.corrected) compute_error_maps(gridded, uncertainty, output.phase);
  std::int64_t empty_bins = 0;
  output.phase("write", [&](const ProgressCallback& progress) {
    empty_bins = write_dem(file, gridded, layers, scans.front()->crs_wkt(), progress);
  });
  return {gridded.bins->inside_count(), gridded.bins->outside_count(), empty_bins, std::move(warnings),
          returns_used(scans)};
}

}  // namespace landfall
