// SPDX-License-Identifier: GPL-3.0-or-later
// A terrain that is not the one of the DEM is a warning, not an error as in `regrid`: only true elevations
// of filled holes depend on it, and the DEM's `z_true` may come from another file than its scans.
#include "app/cli/hazard_input.h"

#include <utility>
#include <vector>

#include "app/runs/placed_scene.h"
#include "base/text/number_text.h"

namespace landfall::cli {
namespace {

bool is_upstream(const nlohmann::json& chain, const std::string& file_id) {
  for (const nlohmann::json& step : chain)
    if (step.value("file_id", "") == file_id) return true;
  return false;
}

/// Gives the bins of filled holes the elevation of the terrain.
void fill_from_terrain(Session& session, const HazardInputFiles& files, const HazardSource& source,
                       const std::vector<FillableBin>& holes, Grid<double>& z_true, Provenance& provenance) {
  Scene terrain;
  session.phase("terrain", [&](const ProgressCallback& progress) {
    terrain = open_scene({.terrain = files.terrain, .use = SceneUse::surface}, progress);
  });
  provenance.add_input("terrain", terrain.file_id, terrain.chain);
  const Meeting meeting = meet(meeting_kind("terrain_of_dem"), {files.map, source.crs_wkt},
                               {files.terrain, terrain.crs_wkt}, files.rules);
  std::vector<std::string> said;
  add_said(said, files.terrain, meeting);
  for (const std::string& line : said) session.warn(line);
  terrain = placed_scene(std::move(terrain), meeting.placement);
  if (!is_upstream(source.chain, terrain.file_id))
    session.warn(files.terrain + " is not the terrain that " + files.map + " was made from");
  const TruthCentroids centroids = read_truth_centroids(files.map);
  for (const TruthPosition& at : truth_positions(z_true, centroids.x, centroids.y, holes)) {
    if (terrain.window) {
      const SitePoint place = meeting.placement.to_second({at.x_m, at.y_m});
      terrain.window->require({place.x_m, place.x_m, place.y_m, place.y_m});
    }
    z_true.at(at.bin) = terrain.surface->elevation(at.x_m, at.y_m);
  }
}

void warn_of_missing_sigma(Session& session, const std::string& map, const HazardInput& input) {
  if (input.bins_without_sigma == 0) return;
  session.warn(map + ": z_sigma_rel: " +
               (input.z_sigma
                    ? "bins with an elevation and without a 1-sigma: " + grouped(input.bins_without_sigma) +
                          "; p_safe does not use their elevations"
                    : "no bin with an elevation has a 1-sigma; there is no p_safe") +
               " (z_sigma_m gives such bins one)");
}

}  // namespace

HazardInput complete_hazard_input(Session& session, const HazardInputFiles& files, HazardSource& source,
                                  const HazardParameters& parameters, Provenance& provenance) {
  if (!files.terrain.empty() && !source.z_true)
    session.warn("--terrain is ignored: " + files.map + " has no true elevations (z_true)");
  HazardInput input = fill_map({std::move(source.z), std::move(source.z_true), std::move(source.z_sigma),
                                std::move(source.noise_sigma), std::move(source.centroids)},
                               parameters, [&](Grid<double>& z_true, const std::vector<FillableBin>& holes) {
                                 if (files.terrain.empty()) return fill_truth(z_true, holes);
                                 fill_from_terrain(session, files, source, holes, z_true, provenance);
                                 return BinMask(z_true.spec());
                               });
  warn_of_missing_sigma(session, files.map, input);
  return input;
}

}  // namespace landfall::cli
