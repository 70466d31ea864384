// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "chain/terrain/mesh/triangle_mesh.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// Writes terrain.h5 of a mesh: /mesh/vertices (V, 3) float64 and /mesh/triangles (F, 3) int32, in a local
/// site frame.
void write_mesh_terrain(LandfallFileWriter& file, const IndexedTriangles& mesh);

/// Throws FormatError if /mesh has another form or fewer bytes than it claims, or if the mesh is not valid.
[[nodiscard]] std::shared_ptr<const TriangleMesh> read_mesh_terrain(const LandfallFileReader& file);

}  // namespace landfall
