// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D32
#include "chain/ray/cgal_engine.h"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

namespace landfall {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using ExactKernel = CGAL::Simple_cartesian<CGAL::Exact_rational>;

template <class K>
typename K::Point_3 cgal_point(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

template <class K>
typename K::Triangle_3 cgal_triangle(const std::array<Eigen::Vector3d, 3>& corners) {
  return {cgal_point<K>(corners[0]), cgal_point<K>(corners[1]), cgal_point<K>(corners[2])};
}

/// The corner that both triangles of a cell share. The construction of the tree reads it some 50 times per
/// triangle, so it is read from the nodes directly: this computes one corner instead of three.
Kernel::Point_3 reference_corner(const TriangulatedGrid& terrain, std::size_t id) {
  const GridSpec& spec = terrain.nodes().spec();
  const auto cell = static_cast<std::int64_t>(id / 2);
  const BinIndex node{cell / (spec.cols - 1), cell % (spec.cols - 1) + 1};
  return {spec.x(node.col), spec.y(node.row), terrain.nodes().at(node)};
}

Kernel::Point_3 reference_corner(const TriangleMesh& terrain, std::size_t id) {
  return cgal_point<Kernel>(terrain.data().vertices[terrain.data().triangles[id][0]]);
}

/// One triangle of a terrain as the tree stores it: by its number. (Concept AABBPrimitiveWithSharedData.)
template <class Surface>
class SurfaceTriangle {
 public:
  using Id = std::size_t;
  using Point = Kernel::Point_3;
  using Datum = Kernel::Triangle_3;
  using Shared_data = const Surface*;

  explicit SurfaceTriangle(Id id) : id_(id) {}
  static Shared_data construct_shared_data(const Surface& terrain) { return &terrain; }

  [[nodiscard]] Id id() const { return id_; }
  [[nodiscard]] std::array<Eigen::Vector3d, 3> corners(Shared_data terrain) const {
    return terrain->triangle(id_);
  }
  [[nodiscard]] Datum datum(Shared_data terrain) const { return cgal_triangle<Kernel>(corners(terrain)); }
  [[nodiscard]] Point reference_point(Shared_data terrain) const { return reference_corner(*terrain, id_); }

 private:
  Id id_;
};

/// A ray as the tree queries it: from `origin` through `second`.
struct Query {
  Eigen::Vector3d origin;
  Eigen::Vector3d direction;
  Eigen::Vector3d second;
  Kernel::Ray_3 ray;
  Eigen::Array3d inverse_step;  ///< 1 / (second - origin), infinite where that difference is 0
  double step_m;                ///< |second - origin|

  /// CGAL's rays store a second point instead of a direction. The rounding error of that point is that of the
  /// larger of the origin's coordinates and the step, so a step as large as any coordinate keeps the angle to
  /// about 2^-52. A much larger step would gain nothing and would defeat the kernel's floating-point filters,
  /// whose error bound grows with the cube of the step while the determinants grow linearly. A power of two
  /// scales the direction without rounding.
  Query(const Ray& r, double terrain_extent_m) : origin(r.origin.v), direction(r.direction.v) {
    const double largest = std::max(origin.cwiseAbs().maxCoeff(), terrain_extent_m);
    second = origin + std::ldexp(1.0, std::ilogb(std::max(largest, 1.0)) + 1) * direction;
    ray = Kernel::Ray_3(cgal_point<Kernel>(origin), cgal_point<Kernel>(second));
    inverse_step = (second - origin).array().inverse();
    step_m = (second - origin).norm();
  }
};

/// Distance to the triangle's plane; NaN unless the error bound of the double evaluation is below 1e-9 m. The
/// bound: the cross product, the dot product and the quotient each add a few units of 2^-53 times the product
/// of the lengths involved; 32 units cover the sum.
double plane_range_m(const Query& q, const std::array<Eigen::Vector3d, 3>& corners) {
  constexpr double kBound_m = 1e-9;
  const Eigen::Vector3d e1 = corners[1] - corners[0];
  const Eigen::Vector3d e2 = corners[2] - corners[0];
  const Eigen::Vector3d to_corner = corners[0] - q.origin;
  const Eigen::Vector3d normal = e1.cross(e2);
  const double cosine = normal.dot(q.direction);
  const double range = normal.dot(to_corner) / cosine;
  const double error = 32 * 0x1p-53 * e1.norm() * e2.norm() * (to_corner.norm() + std::abs(range));
  const bool sharp = error < kBound_m * std::abs(cosine);
  return sharp ? std::max(range, 0.0) : std::numeric_limits<double>::quiet_NaN();
}

/// Distance to the first common point, correctly rounded except for the square root. The ray must meet the
/// triangle; it may lie in the triangle's plane.
double exact_range_m(const Query& q, const std::array<Eigen::Vector3d, 3>& corners) {
  const auto origin = cgal_point<ExactKernel>(q.origin);
  const ExactKernel::Ray_3 ray(origin, cgal_point<ExactKernel>(q.second));
  const auto common = CGAL::intersection(ray, cgal_triangle<ExactKernel>(corners));
  const auto distance = [&](const ExactKernel::Point_3& p) {
    return std::sqrt(CGAL::to_double(CGAL::squared_distance(origin, p)));
  };
  if (const auto* point = boost::get<ExactKernel::Point_3>(&*common)) return distance(*point);
  const auto& piece = boost::get<ExactKernel::Segment_3>(*common);
  return std::min(distance(piece.source()), distance(piece.target()));
}

/// Walks the tree, nearer child first, and keeps the first hit. (A traversal traits class of CGAL's tree.)
///
/// CGAL's own first_intersection cuts boxes with unguarded double arithmetic, which can lose a ray that runs
/// along a box's face, and allocates a queue for each ray.
template <class Primitive>
class FirstHit {
 public:
  using Priority = double;

  explicit FirstHit(typename Primitive::Shared_data shared) : shared_(shared) {}

  [[nodiscard]] bool go_further() const { return true; }

  void intersection(const Query& q, const Primitive& primitive) {
    const auto corners = primitive.corners(shared_);
    if (!CGAL::do_intersect(q.ray, cgal_triangle<Kernel>(corners))) return;
    double range = plane_range_m(q, corners);
    if (std::isnan(range)) range = exact_range_m(q, corners);
    range_m_ = std::min(range_m_, range);
  }

  template <class Node>
  [[nodiscard]] bool do_intersect(const Query& q, const Node& node) const {
    return do_intersect_with_priority(q, node).first;
  }

  /// Whether the ray may enter the box before the best hit, and how early. Each bound of the step is within 4
  /// units of 2^-53 of the exact bound; widening the interval by 2^-49 covers the error of both bounds, so
  /// that no box that the exact ray touches is lost (Ize, "Robust BVH ray traversal", JCGT 2013).
  template <class Node>
  [[nodiscard]] std::pair<bool, Priority> do_intersect_with_priority(const Query& q, const Node& node) const {
    constexpr double kWiden = 1 + 0x1p-49;
    double enter = 0;
    double leave = range_m_ / q.step_m;
    for (int axis = 0; axis < 3; ++axis) {
      const double low = node.bbox().min(axis) - q.origin[axis];
      const double high = node.bbox().max(axis) - q.origin[axis];
      const double inverse = q.inverse_step[axis];
      if (std::isinf(inverse)) {
        if (low > 0 || high < 0) return {false, 0};
        continue;
      }
      enter = std::max(enter, std::min(low * inverse, high * inverse));
      leave = std::min(leave, std::max(low * inverse, high * inverse));
    }
    return {enter <= leave * kWiden, -enter};
  }

  [[nodiscard]] double range_m() const {
    return std::isinf(range_m_) ? std::numeric_limits<double>::quiet_NaN() : range_m_;
  }

 private:
  typename Primitive::Shared_data shared_;
  double range_m_ = std::numeric_limits<double>::infinity();
};

/// The engine over a grid or a mesh.
template <class Surface>
class AabbTreeEngine final : public RayEngine {
 public:
  AabbTreeEngine(std::shared_ptr<const Surface> surface, const ProgressCallback& progress)
      : surface_(std::move(surface)), tree_(traits_of(*surface_)) {
    insert_triangles(progress);
    if (!tree_.empty()) build_tree();
    report(progress, 1);
  }

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    std::transform(rays.begin(), rays.end(), ranges.begin(), [&](const Ray& ray) { return first_hit(ray); });
  }

 private:
  using Primitive = SurfaceTriangle<Surface>;
  using Traits = CGAL::AABB_traits<Kernel, Primitive>;

  void insert_triangles(const ProgressCallback& progress) {
    constexpr double kShare = 0.1;  // of the time; building the tree takes the rest
    constexpr std::size_t kPerReport = 1U << 16U;
    const std::size_t count = surface_->triangle_count();
    for (std::size_t id = 0; id < count; ++id) {
      if (id % kPerReport == 0)
        report(progress, kShare * static_cast<double>(id) / static_cast<double>(count));
      const auto corners = surface_->triangle(id);
      if (corners[0].allFinite() && corners[1].allFinite() && corners[2].allFinite())
        tree_.insert(Primitive(id));
    }
    report(progress, kShare);
  }

  void build_tree() {
    tree_.build();  // built here by one thread, so that queries only read
    const CGAL::Bbox_3 box = tree_.bbox();
    for (int axis = 0; axis < 3; ++axis)
      extent_m_ = std::max({extent_m_, std::abs(box.min(axis)), std::abs(box.max(axis))});
  }

  static Traits traits_of(const Surface& surface) {
    Traits traits;
    traits.set_shared_data(surface);
    return traits;
  }

  [[nodiscard]] double first_hit(const Ray& ray) const {
    FirstHit<Primitive> hit(&*surface_);
    if (ray.origin.v.allFinite() && ray.direction.v.allFinite())
      tree_.traversal_with_priority(Query(ray, extent_m_), hit);
    return hit.range_m();
  }

  std::shared_ptr<const Surface> surface_;
  CGAL::AABB_tree<Traits> tree_;
  double extent_m_ = 0;
};

}  // namespace

std::unique_ptr<RayEngine> make_cgal_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                            const ProgressCallback& progress) {
  return std::make_unique<AabbTreeEngine<TriangulatedGrid>>(std::move(terrain), progress);
}

std::unique_ptr<RayEngine> make_cgal_engine(std::shared_ptr<const TriangleMesh> terrain,
                                            const ProgressCallback& progress) {
  return std::make_unique<AabbTreeEngine<TriangleMesh>>(std::move(terrain), progress);
}

}  // namespace landfall
