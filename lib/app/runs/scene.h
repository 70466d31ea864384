// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "base/core/progress.h"
#include "chain/ray/windowed_terrain.h"
#include "store/files/terrain_file.h"

namespace landfall {

/// The terrain data that a run needs.
enum class SceneUse {
  identity,  ///< only the identity of the terrain
  surface,   ///< also its elevations and normals
  rays,      ///< also an engine that traces rays to it
};

enum class EngineKind { automatic, heightfield, cgal };

/// The terrain of a run. This folder lies above files and ray because it joins them: a file reader needs no
/// ray engine, and a ray engine needs no file.
struct Scene : TerrainIdentity {
  std::shared_ptr<const TerrainSurface> surface{};  ///< null if only the identity was requested
  std::shared_ptr<const RayEngine> engine{};        ///< null unless rays were requested
  std::string engine_name = "none";                 ///< "heightfield", "cgal" or "flat"
  /// The same object as `surface` if only the part in use of a large terrain is loaded; else null.
  std::shared_ptr<const WindowedTerrain> window{};
};

struct SceneRequest {
  std::filesystem::path terrain{};  ///< terrain.h5; empty: infinite level terrain, z = 0
  SceneUse use = SceneUse::rays;
  EngineKind engine = EngineKind::automatic;        ///< automatic: cgal for a mesh, else heightfield
  std::int64_t max_loaded_nodes = kMaxLoadedNodes;  ///< a grid with more nodes is loaded in part
};

/// Makes the engine that traces a terrain in memory: cgal for a mesh, else heightfield.
[[nodiscard]] Scene traced_scene(const TerrainInput& terrain);

/// Opens level terrain, a grid, a grid that is loaded in part, or a mesh. Throws FormatError as
/// read_terrain() and open_large_terrain() do, and UsageError if heightfield is requested for a mesh.
[[nodiscard]] Scene open_scene(const SceneRequest& request, const ProgressCallback& progress = {});

}  // namespace landfall
