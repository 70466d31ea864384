// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "base/numerics/exact_arithmetic.h"
#include "chain/ray/engine.h"

namespace landfall {

/// Tests one ray against one triangle at a time without leaks. The oracle is built on it, and other engines
/// use it where their own arithmetic cannot decide.
///
/// The test is that of Woop, Benthin and Wald ("Watertight ray/triangle intersection", JCGT 2013) in
/// quadruple precision: a triangle's corners are sheared so that the ray becomes an axis, and the signs of
/// three 2-D edge functions decide. Triangles that share a corner see the same sheared corner, and each sign
/// is exact for the sheared corners (ties are settled by the products' errors), so no ray slips between
/// neighbours. The shear rounds: a ray that passes a border of the surface within about 1e-33 of its distance
/// may hit or miss.
class WatertightRay {
 public:
  /// The ray must be finite.
  explicit WatertightRay(const Ray& ray);

  /// Distance to the first point in common with the triangle, metres, >= 0; infinite for a miss or where a
  /// corner is not finite. A ray in the triangle's plane meets the triangle where it enters it. An origin
  /// less than 1e-15 m beyond the triangle counts as on it: range 0.
  [[nodiscard]] double range_to(const std::array<Eigen::Vector3d, 3>& corners) const;

 private:
  using Real = Quad;
  /// A corner in the ray's own coordinates: the ray is the axis x = y = 0, `depth` is monotone along it.
  struct Corner {
    Real x;
    Real y;
    Real depth;
  };
  using Triangle = std::array<Corner, 3>;

  [[nodiscard]] Corner sheared(const Eigen::Vector3d& point) const;
  [[nodiscard]] double first_range(Real depth_a, Real depth_b) const;
  [[nodiscard]] double edge_on_range(const Triangle& t) const;
  [[nodiscard]] static int side(const Corner& p, const Corner& q);
  [[nodiscard]] static bool edge_crosses(const Corner& p, const Corner& q, Real& depth);

  Eigen::Vector3d origin_;
  Eigen::Index axis_ = 0;  ///< the axis of the ray's largest component, which is kept
  Real along_ = 1;
  Real slope_x_ = 0;
  Real slope_y_ = 0;
};

}  // namespace landfall
