// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "base/progress.h"
#include "files/terrain_file.h"
#include "ray/windowed_terrain.h"

namespace landfall {

/// What a run needs of its ground.
enum class SceneUse {
  identity,  ///< which terrain it is
  surface,   ///< also its elevations and normals
  rays,      ///< also an engine that traces rays to it
};

enum class EngineKind { automatic, heightfield, cgal };

/// The ground of a run. This folder lies above files and ray because it joins them: a file reader needs no
/// engine, and an engine needs no file.
struct Scene : TerrainIdentity {
  std::shared_ptr<const TerrainSurface> surface{};  ///< null where only the identity was asked for
  std::shared_ptr<const RayEngine> engine{};        ///< null unless rays were asked for
  std::string engine_name = "none";                 ///< "heightfield", "cgal" or "flat"
  /// The same object as `surface` where only the part in use of a large terrain is loaded; else null.
  std::shared_ptr<const WindowedTerrain> window{};
};

struct SceneRequest {
  std::filesystem::path terrain{};  ///< terrain.h5; empty: level ground, z = 0, without end
  SceneUse use = SceneUse::rays;
  EngineKind engine = EngineKind::automatic;        ///< automatic: cgal for a mesh, else heightfield
  std::int64_t max_loaded_nodes = kMaxLoadedNodes;  ///< a grid of more nodes is loaded in part
};

/// Opens level ground, a grid, a grid that is loaded in part, or a mesh. Throws FormatError as read_terrain()
/// and open_large_terrain() do, and UsageError where a mesh is to be traced by the heightfield engine.
[[nodiscard]] Scene open_scene(const SceneRequest& request, const ProgressCallback& progress = {});

}  // namespace landfall
