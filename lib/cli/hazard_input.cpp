// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/hazard_input.h"

#include <utility>
#include <vector>

#include "scene/scene.h"

namespace landfall::cli {
namespace {

bool is_upstream(const nlohmann::json& chain, const std::string& file_id) {
  for (const nlohmann::json& step : chain)
    if (step.value("file_id", "") == file_id) return true;
  return false;
}

/// Gives the bins of filled holes the elevation of the terrain.
void fill_from_terrain(Session& session, const HazardInputFiles& files, const HazardSource& source,
                       const std::vector<FillableBin>& holes, HazardInput& input, Provenance& provenance) {
  Scene terrain;
  session.phase("terrain", [&](const ProgressCallback& progress) {
    terrain = open_scene({.terrain = files.terrain, .use = SceneUse::surface}, progress);
  });
  provenance.add_input("terrain", terrain.file_id, terrain.chain);
  if (!is_upstream(source.chain, terrain.file_id))
    session.warn(files.terrain + " is not the terrain that " + files.map + " was made from");
  const TruthCentroids centroids = read_truth_centroids(files.map);
  const std::vector<TruthPosition> positions =
      truth_positions(*input.z_true, centroids.x, centroids.y, holes);
  for (const TruthPosition& at : positions) {
    if (terrain.window) terrain.window->require({at.x_m, at.x_m, at.y_m, at.y_m});
    input.z_true->at(at.bin) = terrain.surface->elevation(at.x_m, at.y_m);
  }
}

}  // namespace

HazardInput complete_hazard_input(Session& session, const HazardInputFiles& files, HazardSource& source,
                                  const HazardParameters& parameters, Provenance& provenance) {
  BinMask nothing_filled(source.z.spec());
  HazardInput input{std::move(source.z), std::move(source.z_true), std::move(nothing_filled),
                    std::move(source.z_sigma)};
  const std::vector<FillableBin> holes = small_holes(input.z, parameters.hole_fill_bins);
  if (input.z_true && !files.terrain.empty())
    fill_from_terrain(session, files, source, holes, input, provenance);
  else if (input.z_true)
    input.filled_truth = fill_truth(*input.z_true, holes);
  if (!files.terrain.empty() && !input.z_true)
    session.warn("--terrain is ignored: " + files.map + " has no true elevations (z_true)");
  fill_holes(input.z, holes);
  if (input.z_sigma)
    fill_holes(*input.z_sigma, holes);
  else if (parameters.z_sigma_m)
    input.z_sigma = Grid<double>(input.z.spec(), *parameters.z_sigma_m);
  return input;
}

}  // namespace landfall::cli
