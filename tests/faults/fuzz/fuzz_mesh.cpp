// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files, as terrain-gen --from takes them.
//
// An input is a letter (o: OBJ, p: PLY, f: OFF, s: STL, t: shape table) and the file.
#include <cmath>

#include "chain/terrain/mesh/triangle_mesh.h"
#include "formats/mesh/mesh_file.h"
#include "fuzz_target.h"

namespace landfall::fuzz {
namespace {

constexpr const char* kName = "input.mesh";

PolygonSoup parse(std::uint8_t format, const std::string& bytes) {
  switch (format) {
    case 'p':
      return parse_ply(bytes, kName);
    case 'f':
      return parse_off(bytes, kName);
    case 's':
      return parse_stl(bytes, kName);
    case 't':
      return parse_shape_table(bytes, kName);
    default:
      return parse_obj(bytes, kName);
  }
}

void require(bool holds, const char* what) {
  if (!holds) throw BrokenPromise(what);
}

/// Over its own vertices a mesh has a height, and on its triangles a direction.
void use(const TriangleMesh& mesh) {
  for (std::size_t i = 0; i < mesh.triangle_count(); i += 1 + mesh.triangle_count() / 16) {
    const Eigen::Vector3d corner = mesh.triangle(i)[0];
    require(mesh.elevation(corner.x(), corner.y()) >= corner.z(), "a mesh below its own vertex");
    require(std::abs(mesh.normal(corner).norm() - 1) < 1e-9, "a triangle without a direction");
  }
}

void read(std::uint8_t format, const std::string& bytes) {
  PolygonSoup soup = parse(format, bytes);
  require(soup.polygon_ends.empty() || soup.polygon_ends.back() == soup.corners.size(),
          "polygons of other corners");
  const std::size_t points = soup.points.size();
  const MeshPlacement placement{2, {0.1, 0.2, 0.3}, {1, 2, 3}};
  const CleanMesh clean = clean_mesh(std::move(soup), placement, kName);
  require(clean.mesh.vertices.size() + clean.welded_vertex_count + clean.unreferenced_vertex_count == points,
          "vertices that were not counted");
  use(TriangleMesh(clean.mesh, kName));
}

}  // namespace
}  // namespace landfall::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace landfall::fuzz;
  InputBytes input({data, size});
  const std::uint8_t format = input.byte();
  const std::string bytes = input.rest();
  static_cast<void>(accepts(kName, [&] { read(format, bytes); }));
  return 0;
}
