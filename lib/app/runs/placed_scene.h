// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "app/runs/scene.h"
#include "store/files/meeting.h"

namespace landfall {

/// A scene whose surface answers in the frame of the first of two files that met, where the terrain was the
/// second: H(x, y) there is H at the point's own place on the terrain, moved by the placement's height. Its
/// normals are those of the terrain; a reprojection's turn of the axes (below the convergence of meridians
/// across a site) is not applied to them. The engine is dropped, because rays have not met.
[[nodiscard]] Scene placed_scene(Scene scene, const Placement& placement);

/// Loads the part of a large terrain under a grid of the first's frame.
void require_window(const Scene& scene, const GridSpec& grid, const Placement& placement);

}  // namespace landfall
