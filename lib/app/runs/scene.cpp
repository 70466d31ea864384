// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/scene.h"

#include <utility>

#include "base/core/error.h"
#include "chain/ray/cgal_engine.h"
#include "chain/ray/flat_terrain.h"
#include "chain/ray/heightfield_engine.h"

namespace landfall {
namespace {

/// Maps the progress of a part to the interval [begin, end] of the whole.
ProgressCallback share_of(const ProgressCallback& whole, double begin, double end) {
  return [whole, begin, end](double fraction) { report(whole, begin + fraction * (end - begin)); };
}

Scene level_scene() {
  const auto terrain = std::make_shared<const FlatTerrain>();
  Scene scene;
  scene.surface = terrain;
  scene.engine = terrain;
  scene.engine_name = "flat";
  return scene;
}

EngineMaker maker_of(EngineKind kind, const ProgressCallback& progress = {}) {
  return [=](std::shared_ptr<const TriangulatedGrid> grid) -> std::unique_ptr<const RayEngine> {
    if (kind == EngineKind::cgal) return make_cgal_engine(std::move(grid), progress);
    return make_heightfield_engine(std::move(grid), progress);
  };
}

const char* engine_name_of(EngineKind kind) { return kind == EngineKind::cgal ? "cgal" : "heightfield"; }

Scene windowed_scene(LargeTerrainInput large, const SceneRequest& request) {
  Scene scene{TerrainIdentity(large)};
  const bool traced = request.use == SceneUse::rays;
  scene.window = std::make_shared<const WindowedTerrain>(std::move(large.terrain),
                                                         traced ? maker_of(request.engine) : EngineMaker());
  scene.surface = scene.window;
  if (!traced) return scene;
  scene.engine = scene.window;
  scene.engine_name = engine_name_of(request.engine);
  return scene;
}

Scene with_engine(const TerrainInput& terrain, EngineKind kind, const ProgressCallback& progress) {
  Scene scene{TerrainIdentity(terrain), terrain.surface};
  if (terrain.mesh)
    scene.engine = make_cgal_engine(terrain.mesh, progress);
  else
    scene.engine = maker_of(kind, progress)(terrain.grid);
  scene.engine_name = terrain.mesh ? engine_name_of(EngineKind::cgal) : engine_name_of(kind);
  return scene;
}

Scene loaded_scene(const SceneRequest& request, const ProgressCallback& progress) {
  const bool traced = request.use == SceneUse::rays;
  const TerrainInput terrain = read_terrain(request.terrain, share_of(progress, 0, traced ? 0.5 : 1));
  if (!traced) return {TerrainIdentity(terrain), terrain.surface};
  if (terrain.mesh && request.engine == EngineKind::heightfield)
    throw UsageError(
        request.terrain.string() + ": is a mesh, which the engine heightfield cannot trace; use cgal or auto",
        "engine");
  return with_engine(terrain, request.engine, share_of(progress, 0.5, 1));
}

}  // namespace

Scene open_scene(const SceneRequest& request, const ProgressCallback& progress) {
  if (request.terrain.empty()) return level_scene();
  if (request.use == SceneUse::identity) return {read_terrain_identity(request.terrain)};
  auto large = open_large_terrain(request.terrain, request.max_loaded_nodes, progress);
  return large ? windowed_scene(std::move(*large), request) : loaded_scene(request, progress);
}

Scene traced_scene(const TerrainInput& terrain) { return with_engine(terrain, EngineKind::automatic, {}); }

}  // namespace landfall
