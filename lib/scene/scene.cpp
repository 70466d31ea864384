// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <optional>
#include <utility>

#include "base/error.h"
#include "ray/cgal_engine.h"
#include "ray/flat_ground.h"
#include "ray/heightfield_engine.h"

namespace landfall {
namespace {

/// Maps the progress of a part to the interval [begin, end] of the whole.
ProgressCallback part_of(const ProgressCallback& whole, double begin, double end) {
  return [whole, begin, end](double fraction) { report(whole, begin + fraction * (end - begin)); };
}

Scene level_scene() {
  const auto ground = std::make_shared<const FlatGround>();
  Scene scene;
  scene.surface = ground;
  scene.engine = ground;
  scene.engine_name = "flat";
  return scene;
}

const char* grid_engine_name(EngineKind kind) { return kind == EngineKind::cgal ? "cgal" : "heightfield"; }

EngineMaker grid_engine_maker(EngineKind kind, const ProgressCallback& progress = {}) {
  return [kind, progress](std::shared_ptr<const TriangulatedGrid> grid) -> std::unique_ptr<const RayEngine> {
    if (kind == EngineKind::cgal) return make_cgal_engine(std::move(grid), progress);
    return make_heightfield_engine(std::move(grid), progress);
  };
}

Scene windowed_scene(LargeTerrainInput large, const SceneRequest& request) {
  Scene scene{TerrainIdentity(large)};
  const bool traced = request.use == SceneUse::rays;
  scene.window = std::make_shared<const WindowedTerrain>(
      std::move(large.terrain), traced ? grid_engine_maker(request.engine) : EngineMaker());
  scene.surface = scene.window;
  if (!traced) return scene;
  scene.engine = scene.window;
  scene.engine_name = grid_engine_name(request.engine);
  return scene;
}

Scene loaded_scene(const SceneRequest& request, const ProgressCallback& progress) {
  const bool traced = request.use == SceneUse::rays;
  const TerrainInput terrain = read_terrain(request.terrain, part_of(progress, 0, traced ? 0.5 : 1));
  Scene scene{TerrainIdentity(terrain), terrain.surface};
  if (!traced) return scene;
  if (terrain.mesh && request.engine == EngineKind::heightfield)
    throw UsageError(
        request.terrain.string() + ": is a mesh, which the engine heightfield cannot trace; use cgal or auto",
        "engine");
  const ProgressCallback rest = part_of(progress, 0.5, 1);
  if (terrain.mesh) {
    scene.engine = make_cgal_engine(terrain.mesh, rest);
    scene.engine_name = "cgal";
  } else {
    scene.engine = grid_engine_maker(request.engine, rest)(terrain.grid);
    scene.engine_name = grid_engine_name(request.engine);
  }
  return scene;
}

}  // namespace

Scene open_scene(const SceneRequest& request, const ProgressCallback& progress) {
  if (request.terrain.empty()) return level_scene();
  if (request.use == SceneUse::identity) return {read_terrain_identity(request.terrain)};
  auto large = open_large_terrain(request.terrain, request.max_loaded_nodes, progress);
  return large ? windowed_scene(std::move(*large), request) : loaded_scene(request, progress);
}

}  // namespace landfall
