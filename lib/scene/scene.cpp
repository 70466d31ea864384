// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/scene.h"

#include <utility>

#include "base/error.h"
#include "opencl/opencl_engine.h"
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

bool asks_device(EngineKind kind) { return kind == EngineKind::opencl || kind == EngineKind::opencl_or_cpu; }

/// Makes engines of the requested kind for grids, and knows what became of them.
class GridEngines {
 public:
  explicit GridEngines(EngineKind kind)
      : kind_(kind), use_(asks_device(kind) ? std::make_shared<DeviceUse>() : nullptr) {}

  [[nodiscard]] EngineMaker maker(const ProgressCallback& progress = {}) const {
    return [kind = kind_, use = use_,
            progress](std::shared_ptr<const TriangulatedGrid> grid) -> std::unique_ptr<const RayEngine> {
      if (kind == EngineKind::cgal) return make_cgal_engine(std::move(grid), progress);
      if (!asks_device(kind)) return make_heightfield_engine(std::move(grid), progress);
      const OpenClOptions options{
          .on_failure = kind == EngineKind::opencl ? DeviceFailure::throws : DeviceFailure::falls_back,
          .use = use};
      return make_opencl_engine(std::move(grid), options, progress);
    };
  }
  /// Adds an engine, and what it is, to a scene.
  void add_to(Scene& scene, std::shared_ptr<const RayEngine> engine) const {
    scene.engine = std::move(engine);
    scene.device_use = use_;
    const bool on_device = use_ != nullptr && !use_->failure();
    scene.engine_name = kind_ == EngineKind::cgal ? "cgal" : on_device ? "opencl" : "heightfield";
  }
  void add_mesh_to(Scene& scene, const TerrainInput& terrain, const ProgressCallback& progress) const {
    scene.engine = make_cgal_engine(terrain.mesh, progress);
    scene.engine_name = "cgal";
    scene.device_use = use_;
    if (use_ != nullptr) use_->fell_back("the terrain is a mesh, which the engine opencl cannot trace");
  }

 private:
  EngineKind kind_;
  std::shared_ptr<DeviceUse> use_;
};

Scene windowed_scene(LargeTerrainInput large, const SceneRequest& request) {
  Scene scene{TerrainIdentity(large)};
  const bool traced = request.use == SceneUse::rays;
  const GridEngines engines(request.engine);
  scene.window = std::make_shared<const WindowedTerrain>(std::move(large.terrain),
                                                         traced ? engines.maker() : EngineMaker());
  scene.surface = scene.window;
  if (traced) engines.add_to(scene, scene.window);
  return scene;
}

void refuse_mesh(const SceneRequest& request) {
  const char* const engine = request.engine == EngineKind::opencl        ? "opencl"
                             : request.engine == EngineKind::heightfield ? "heightfield"
                                                                         : nullptr;
  if (engine != nullptr)
    throw UsageError(request.terrain.string() + ": is a mesh, which the engine " + engine +
                         " cannot trace; use cgal or auto",
                     "engine");
}

Scene with_engine(const TerrainInput& terrain, EngineKind kind, const ProgressCallback& progress) {
  Scene scene{TerrainIdentity(terrain), terrain.surface};
  const GridEngines engines(kind);
  if (terrain.mesh)
    engines.add_mesh_to(scene, terrain, progress);
  else
    engines.add_to(scene, engines.maker(progress)(terrain.grid));
  return scene;
}

Scene loaded_scene(const SceneRequest& request, const ProgressCallback& progress) {
  const bool traced = request.use == SceneUse::rays;
  const TerrainInput terrain = read_terrain(request.terrain, part_of(progress, 0, traced ? 0.5 : 1));
  if (!traced) return {TerrainIdentity(terrain), terrain.surface};
  if (terrain.mesh) refuse_mesh(request);
  return with_engine(terrain, request.engine, part_of(progress, 0.5, 1));
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
