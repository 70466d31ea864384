// SPDX-License-Identifier: GPL-3.0-or-later
#include "ray/brute_force.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

namespace landfall {
namespace {

using Real = long double;

/// A corner in the ray's own coordinates: the ray is the axis x = y = 0, `depth` grows or falls along it.
struct ShearedCorner {
  Real x;
  Real y;
  Real depth;
};
using ShearedTriangle = std::array<ShearedCorner, 3>;

/// Maps points so that the ray becomes an axis; the axis of the ray's largest component is kept.
class Shear {
 public:
  explicit Shear(const Ray& ray) : origin_(ray.origin.v) {
    ray.direction.v.cwiseAbs().maxCoeff(&axis_);
    along_ = ray.direction.v[axis_];
    slope_x_ = Real{ray.direction.v[axis_x()]} / along_;
    slope_y_ = Real{ray.direction.v[axis_y()]} / along_;
  }

  [[nodiscard]] ShearedCorner operator()(const Eigen::Vector3d& point) const {
    const auto difference = [&](Eigen::Index axis) { return Real{point[axis]} - Real{origin_[axis]}; };
    const Real depth = difference(axis_);
    return {difference(axis_x()) - slope_x_ * depth, difference(axis_y()) - slope_y_ * depth, depth};
  }
  [[nodiscard]] Real range_m(Real depth) const { return depth / along_; }

 private:
  [[nodiscard]] Eigen::Index axis_x() const { return (axis_ + 1) % 3; }
  [[nodiscard]] Eigen::Index axis_y() const { return (axis_ + 2) % 3; }

  Eigen::Vector3d origin_;
  Eigen::Index axis_ = 0;
  Real along_ = 1;
  Real slope_x_ = 0;
  Real slope_y_ = 0;
};

/// On which side of the ray the edge from p to q passes; the sign is exact. Rounding is monotone, so that
/// products which differ after rounding are in the right order; equal ones are told apart by what was rounded
/// off.
int side(const ShearedCorner& p, const ShearedCorner& q) {
  const Real left = p.x * q.y;
  const Real right = p.y * q.x;
  if (left != right) return left > right ? 1 : -1;
  const Real left_rest = std::fma(p.x, q.y, -left);
  const Real right_rest = std::fma(p.y, q.x, -right);
  return int{left_rest > right_rest} - int{left_rest < right_rest};
}

/// The smallest range >= 0 among those between two depths on the ray.
std::optional<Real> first_range(const Shear& shear, Real depth_a, Real depth_b) {
  constexpr Real kOnSurface_m = 1e-15L;
  const auto [near, far] = std::minmax({shear.range_m(depth_a), shear.range_m(depth_b)});
  if (far < -kOnSurface_m) return std::nullopt;
  return std::max<Real>(near, 0);
}

/// The depth at which the edge from p to q, in one plane with the ray, crosses it; none where it does not.
/// The whole edge may lie on the ray: its corners then come up as ends of the other two edges.
std::optional<Real> crossing_depth(const ShearedCorner& p, const ShearedCorner& q) {
  const bool along_x = std::abs(p.x) + std::abs(q.x) >= std::abs(p.y) + std::abs(q.y);
  const Real from = along_x ? p.x : p.y;
  const Real to = along_x ? q.x : q.y;
  if (from == 0) return p.depth;
  if ((from < 0) == (to < 0) && to != 0) return std::nullopt;
  return p.depth + (q.depth - p.depth) * (from / (from - to));
}

/// The triangle is seen edge-on: the ray lies in its plane and meets it in a piece of itself, or not at all.
std::optional<Real> edge_on_range(const Shear& shear, const ShearedTriangle& t) {
  std::optional<Real> nearest;
  std::optional<Real> farthest;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<Real> depth = crossing_depth(t[i], t[(i + 1) % 3]);
    if (!depth) continue;
    nearest = std::min(*depth, nearest.value_or(*depth));
    farthest = std::max(*depth, farthest.value_or(*depth));
  }
  if (!nearest) return std::nullopt;
  return first_range(shear, *nearest, *farthest);
}

Real edge_function(const ShearedCorner& p, const ShearedCorner& q) { return p.x * q.y - p.y * q.x; }

std::optional<Real> range_to(const Shear& shear, const std::array<Eigen::Vector3d, 3>& corners) {
  const ShearedTriangle t{shear(corners[0]), shear(corners[1]), shear(corners[2])};
  const auto [least, greatest] = std::minmax({side(t[1], t[2]), side(t[2], t[0]), side(t[0], t[1])});
  if (least < 0 && greatest > 0) return std::nullopt;
  if (least == 0 && greatest == 0) return edge_on_range(shear, t);
  const Real u = edge_function(t[1], t[2]);
  const Real v = edge_function(t[2], t[0]);
  const Real w = edge_function(t[0], t[1]);
  if (u + v + w == 0) return edge_on_range(shear, t);  // so thin a sight that the signs alone see it
  const Real depth = (u * t[0].depth + v * t[1].depth + w * t[2].depth) / (u + v + w);
  return first_range(shear, depth, depth);
}

class BruteForceEngine final : public RayEngine {
 public:
  explicit BruteForceEngine(std::shared_ptr<const TriangulatedGrid> terrain) : terrain_(std::move(terrain)) {}

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    std::transform(rays.begin(), rays.end(), ranges.begin(), [&](const Ray& ray) { return first_hit(ray); });
  }

 private:
  [[nodiscard]] double first_hit(const Ray& ray) const {
    double best = std::numeric_limits<double>::quiet_NaN();
    if (!ray.origin.v.allFinite() || !ray.direction.v.allFinite()) return best;
    const Shear shear(ray);
    for (std::size_t id = 0; id < terrain_->triangle_count(); ++id) {
      const auto corners = terrain_->triangle(id);
      if (!corners[0].allFinite() || !corners[1].allFinite() || !corners[2].allFinite()) continue;
      const std::optional<Real> range = range_to(shear, corners);
      if (range && !(static_cast<double>(*range) >= best)) best = static_cast<double>(*range);
    }
    return best;
  }

  std::shared_ptr<const TriangulatedGrid> terrain_;
};

}  // namespace

std::unique_ptr<RayEngine> make_brute_force_engine(std::shared_ptr<const TriangulatedGrid> terrain) {
  return std::make_unique<BruteForceEngine>(std::move(terrain));
}

}  // namespace landfall
