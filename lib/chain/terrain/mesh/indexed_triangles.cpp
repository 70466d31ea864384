// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/mesh/indexed_triangles.h"

#include <algorithm>

#include "base/core/error.h"
#include "chain/terrain/mesh/orient2d.h"

namespace landfall {

bool has_no_area(const std::array<Eigen::Vector3d, 3>& corners) {
  const auto flat_along = [&](Eigen::Index u, Eigen::Index v) {
    const auto seen = [&](std::size_t i) { return Eigen::Vector2d(corners[i][u], corners[i][v]); };
    return orient2d(seen(0), seen(1), seen(2)) == 0;
  };
  return flat_along(0, 1) && flat_along(1, 2) && flat_along(2, 0);
}

void require_sound(const IndexedTriangles& mesh, const std::string& name) {
  if (mesh.triangles.empty()) throw FormatError(name + ": the mesh has no triangle");
  if (std::max(mesh.vertices.size(), mesh.triangles.size()) > kMaxMeshElements)
    throw FormatError(name + ": more than 2^31 - 1 vertices or triangles");
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    if (!(mesh.vertices[i].cwiseAbs().maxCoeff() <= kLargestCoordinate_m) || !mesh.vertices[i].allFinite())
      throw FormatError(name + ": vertex " + std::to_string(i) +
                        " is not finite, or more than 1e12 m from the origin");
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (const std::uint32_t corner : mesh.triangles[i])
      if (corner >= mesh.vertices.size())
        throw FormatError(name + ": triangle " + std::to_string(i) + " names vertex " +
                          std::to_string(corner) + " of " + std::to_string(mesh.vertices.size()));
    if (has_no_area(mesh.corners(i)))
      throw FormatError(name + ": triangle " + std::to_string(i) + " has no area");
  }
}

}  // namespace landfall
