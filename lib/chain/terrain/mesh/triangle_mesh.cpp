// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D100
#include "chain/terrain/mesh/triangle_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/numerics/exact_arithmetic.h"
#include "base/numerics/non_finite.h"
#include "chain/terrain/mesh/orient2d.h"

namespace landfall {
namespace {

using Corners = std::array<Eigen::Vector3d, 3>;

/// The highest point of an edge above a point that lies on the edge's line as seen from above; minus infinity
/// beside the edge.
double highest_on_edge(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector2d& point) {
  const Eigen::Vector2d low = p.head<2>().cwiseMin(q.head<2>());
  const Eigen::Vector2d high = p.head<2>().cwiseMax(q.head<2>());
  if ((point.array() < low.array()).any() || (point.array() > high.array()).any()) return -kInfinity;
  Eigen::Index along = 0;
  const double length = (high - low).maxCoeff(&along);
  if (length == 0) return std::max(p.z(), q.z());
  const double part = (point[along] - p[along]) / (q[along] - p[along]);
  return std::clamp(p.z() + part * (q.z() - p.z()), std::min(p.z(), q.z()), std::max(p.z(), q.z()));
}

/// The highest point of a vertical triangle above a point, which lies on its line as seen from above.
double highest_of_upright(const Corners& t, const Eigen::Vector2d& point) {
  return std::max({highest_on_edge(t[0], t[1], point), highest_on_edge(t[1], t[2], point),
                   highest_on_edge(t[2], t[0], point)});
}

/// z of the triangle's plane, in quadruple precision, relative to the corner nearest as seen from above.
double plane_elevation(const Corners& t, const Eigen::Vector2d& point) {
  using Vector = Eigen::Matrix<Quad, 3, 1>;
  std::size_t nearest = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if ((t[i].head<2>() - point).squaredNorm() < (t[nearest].head<2>() - point).squaredNorm()) nearest = i;
  const Vector corner = t[nearest].cast<Quad>();
  const Vector e1 = t[(nearest + 1) % 3].cast<Quad>() - corner;
  const Vector e2 = t[(nearest + 2) % 3].cast<Quad>() - corner;
  const Vector n = e1.cross(e2);
  const Quad rise = (n.x() * (corner.x() - point.x()) + n.y() * (corner.y() - point.y())) / n.z();
  return static_cast<double>(corner.z() + rise);
}

/// The highest point of a triangle above a point; minus infinity outside the triangle.
double highest_of(const Corners& t, const Eigen::Vector2d& point) {
  const auto side = [&](std::size_t i) { return orient2d(t[i].head<2>(), t[(i + 1) % 3].head<2>(), point); };
  const auto [minimum, maximum] = std::minmax({side(0), side(1), side(2)});
  if (minimum < 0 && maximum > 0) return -kInfinity;
  // Seen from above, a vertical triangle is a line, on which the point lies if all three sides are 0.
  if (minimum == 0 && maximum == 0) return highest_of_upright(t, point);
  const auto [low, high] = std::minmax({t[0].z(), t[1].z(), t[2].z()});
  const double z = plane_elevation(t, point);
  return std::isnan(z) ? high : std::clamp(z, low, high);
}

/// Squared distance from the origin to the nearest point of a triangle (Ericson, "Real-time collision
/// detection", 2005, 5.1.5).
double squared_distance_to_origin(const Corners& t) {
  const Eigen::Vector3d ab = t[1] - t[0];
  const Eigen::Vector3d ac = t[2] - t[0];
  const double d1 = -ab.dot(t[0]), d2 = -ac.dot(t[0]);
  if (d1 <= 0 && d2 <= 0) return t[0].squaredNorm();
  const double d3 = -ab.dot(t[1]), d4 = -ac.dot(t[1]);
  if (d3 >= 0 && d4 <= d3) return t[1].squaredNorm();
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (t[0] + d1 / (d1 - d3) * ab).squaredNorm();
  const double d5 = -ab.dot(t[2]), d6 = -ac.dot(t[2]);
  if (d6 >= 0 && d5 <= d6) return t[2].squaredNorm();
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (t[0] + d2 / (d2 - d6) * ac).squaredNorm();
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6)
    return (t[1] + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (t[2] - t[1])).squaredNorm();
  const double scale = 1 / (va + vb + vc);
  return (t[0] + vb * scale * ab + vc * scale * ac).squaredNorm();
}

Eigen::Vector3d unit_normal(const Corners& t) {
  const auto component = [&](Eigen::Index u, Eigen::Index v) {
    const auto seen = [&](std::size_t i) { return Eigen::Vector2d(t[i][u], t[i][v]); };
    return orient2d(seen(0), seen(1), seen(2));
  };
  return Eigen::Vector3d(component(1, 2), component(2, 0), component(0, 1)).stableNormalized();
}

/// Throws unless the mesh is sound; otherwise returns it.
IndexedTriangles checked_mesh(IndexedTriangles mesh, const std::string& name) {
  require_sound(mesh, name);
  return mesh;
}

}  // namespace

TriangleMesh::TriangleMesh(IndexedTriangles mesh, const std::string& name)
    : mesh_(checked_mesh(std::move(mesh), name)), tree_(mesh_) {}

double TriangleMesh::elevation(double x_m, double y_m) const {
  const Eigen::Vector2d point(x_m, y_m);
  double highest = -kInfinity;
  tree_.search(
      [&](const TriangleBox& box) { return box.is_over(x_m, y_m) ? -double{box.high[2]} : kInfinity; },
      [&] { return -highest; },
      [&](std::span<const std::uint32_t> triangles) {
        for (const std::uint32_t id : triangles) highest = std::max(highest, highest_of(triangle(id), point));
      });
  return std::isinf(highest) ? kNan : highest;
}

Eigen::Vector3d TriangleMesh::normal(const Eigen::Vector3d& point) const {
  double nearest = kInfinity;
  std::size_t of = 0;
  tree_.search([&](const TriangleBox& box) { return box.squared_distance(point); }, [&] { return nearest; },
               [&](std::span<const std::uint32_t> triangles) {
                 for (const std::uint32_t id : triangles) {
                   Corners t = triangle(id);
                   for (Eigen::Vector3d& corner : t) corner -= point;
                   const double distance = squared_distance_to_origin(t);
                   if (!(distance < nearest || (distance == nearest && id < of))) continue;
                   nearest = distance;
                   of = id;
                 }
               });
  return std::isinf(nearest) ? Eigen::Vector3d::Constant(kNan) : unit_normal(triangle(of));
}

}  // namespace landfall
