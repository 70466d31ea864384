// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D31
#include "chain/ray/watertight.h"

#include <algorithm>
#include <limits>

namespace landfall {
namespace {

constexpr double kMiss = std::numeric_limits<double>::infinity();

Quad magnitude(Quad x) { return x < 0 ? -x : x; }

}  // namespace

WatertightRay::WatertightRay(const Ray& ray) : origin_(ray.origin.v) {
  ray.direction.v.cwiseAbs().maxCoeff(&axis_);
  along_ = ray.direction.v[axis_];
  slope_x_ = Real{ray.direction.v[(axis_ + 1) % 3]} / along_;
  slope_y_ = Real{ray.direction.v[(axis_ + 2) % 3]} / along_;
}

WatertightRay::Corner WatertightRay::sheared(const Eigen::Vector3d& point) const {
  const auto difference = [&](Eigen::Index axis) { return Real{point[axis]} - Real{origin_[axis]}; };
  const Real depth = difference(axis_);
  return {difference((axis_ + 1) % 3) - slope_x_ * depth, difference((axis_ + 2) % 3) - slope_y_ * depth,
          depth};
}

/// The side of the ray on which the edge from p to q passes; the sign is exact. Rounding is monotone, so
/// products that differ after rounding are in the right order; equal products are compared by their rounding
/// errors.
int WatertightRay::side(const Corner& p, const Corner& q) {
  const Real left = p.x * q.y;
  const Real right = p.y * q.x;
  if (left != right) return left > right ? 1 : -1;
  const Real left_rest = product_rest(p.x, q.y, left);
  const Real right_rest = product_rest(p.y, q.x, right);
  return int{left_rest > right_rest} - int{left_rest < right_rest};
}

/// The smallest range >= 0 among the ranges between two depths on the ray.
double WatertightRay::first_range(Real depth_a, Real depth_b) const {
  constexpr double kOnSurface_m = 1e-15;
  const auto [near, far] = std::minmax({depth_a / along_, depth_b / along_});
  if (far < -kOnSurface_m) return kMiss;
  return static_cast<double>(std::max<Real>(near, 0));
}

/// Whether the edge from p to q, coplanar with the ray, crosses it, and at which depth. The whole edge may
/// lie on the ray: its corners are then found as ends of the other two edges.
bool WatertightRay::edge_crosses(const Corner& p, const Corner& q, Real& depth) {
  const bool along_x = magnitude(p.x) + magnitude(q.x) >= magnitude(p.y) + magnitude(q.y);
  const Real from = along_x ? p.x : p.y;
  const Real to = along_x ? q.x : q.y;
  if (from != 0 && to != 0 && (from < 0) == (to < 0)) return false;
  depth = from == 0 ? p.depth : p.depth + (q.depth - p.depth) * (from / (from - to));
  return true;
}

/// The triangle is seen edge-on: the ray lies in its plane and meets it along a segment, or not at all.
double WatertightRay::edge_on_range(const Triangle& t) const {
  Real nearest = kMiss;
  Real farthest = -nearest;
  for (std::size_t i = 0; i < 3; ++i) {
    Real depth = 0;
    if (!edge_crosses(t[i], t[(i + 1) % 3], depth)) continue;
    nearest = std::min(nearest, depth);
    farthest = std::max(farthest, depth);
  }
  return nearest <= farthest ? first_range(nearest, farthest) : kMiss;
}

double WatertightRay::range_to(const std::array<Eigen::Vector3d, 3>& corners) const {
  if (!corners[0].allFinite() || !corners[1].allFinite() || !corners[2].allFinite()) return kMiss;
  const Triangle t{sheared(corners[0]), sheared(corners[1]), sheared(corners[2])};
  const auto [minimum, maximum] = std::minmax({side(t[1], t[2]), side(t[2], t[0]), side(t[0], t[1])});
  if (minimum < 0 && maximum > 0) return kMiss;
  if (minimum == 0 && maximum == 0) return edge_on_range(t);
  const auto edge_function = [](const Corner& p, const Corner& q) { return p.x * q.y - p.y * q.x; };
  const Real u = edge_function(t[1], t[2]);
  const Real v = edge_function(t[2], t[0]);
  const Real w = edge_function(t[0], t[1]);
  if (u + v + w == 0) return edge_on_range(t);  // so nearly edge-on that only the signs are non-zero
  const Real depth = (u * t[0].depth + v * t[1].depth + w * t[2].depth) / (u + v + w);
  return first_range(depth, depth);
}

}  // namespace landfall
