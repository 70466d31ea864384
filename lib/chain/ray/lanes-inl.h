// SPDX-License-Identifier: GPL-3.0-or-later
// Rays and triangles in SIMD lanes. Compiled once for each instruction set (Highway).

#include "base/numerics/lanes-inl.h"
#include "chain/ray/walk_data.h"

#if defined(LANDFALL_RAY_LANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_RAY_LANES_INL_H_
#undef LANDFALL_RAY_LANES_INL_H_
#else
#define LANDFALL_RAY_LANES_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

HWY_INLINE V load(const double* values) { return hn::Load(D(), values); }
HWY_INLINE bool any(M mask) { return !hn::AllFalse(D(), mask); }
HWY_INLINE bool all(M mask) { return hn::AllTrue(D(), mask); }

/// GridRay in SIMD lanes, computed by the same operations.
struct LaneRays {
  V x, y, z, dx, dy, dz, position_error, height_error, horizontal_speed;

  LaneRays() = default;
  HWY_INLINE LaneRays(const RayChunk& chunk, std::size_t i)
      : x(load(chunk.x + i)),
        y(load(chunk.y + i)),
        z(load(chunk.z + i)),
        dx(load(chunk.dx + i)),
        dy(load(chunk.dy + i)),
        dz(load(chunk.dz + i)),
        position_error(load(chunk.position_error + i)),
        height_error(load(chunk.height_error + i)),
        horizontal_speed(hn::Add(hn::Abs(dx), hn::Abs(dy))) {}
};

/// CornerTriangle in SIMD lanes.
struct LaneTriangle {
  V corner, along_x, along_y, x, y, dx, dy;
};

/// certain_range in SIMD lanes, computed by the same operations.
HWY_INLINE V CertainRange(const LaneRays& ray, const LaneTriangle& t) {
  const V slope_x = hn::Sub(t.along_x, t.corner);
  const V slope_y = hn::Sub(t.along_y, t.corner);
  const V steepness = hn::Add(hn::Abs(slope_x), hn::Abs(slope_y));
  const V descent = hn::Sub(hn::Sub(ray.dz, hn::Mul(slope_x, t.dx)), hn::Mul(slope_y, t.dy));
  const V per_descent = hn::Div(constant(1), descent);
  const V rise = hn::Add(hn::Add(hn::Sub(t.corner, ray.z), hn::Mul(slope_x, t.x)), hn::Mul(slope_y, t.y));
  const V range = hn::Mul(rise, per_descent);
  const V range_error =
      hn::Mul(hn::Add(ray.height_error, hn::Mul(steepness, ray.position_error)), hn::Abs(per_descent));
  const V margin = hn::Add(ray.position_error, hn::Mul(ray.horizontal_speed, range_error));
  const V u = hn::Add(t.x, hn::Mul(t.dx, range));
  const V v = hn::Add(t.y, hn::Mul(t.dy, range));
  const V w = hn::Sub(hn::Sub(constant(1), u), v);
  const V outside = hn::Neg(margin);
  // Ne is not usable: it is false for NaN on some instruction sets.
  const M hole = hn::Not(hn::Eq(hn::Sub(steepness, steepness), constant(0)));
  const M beside = hn::Or(hn::Or(hn::Lt(u, outside), hn::Lt(v, outside)), hn::Lt(w, outside));
  const M miss = hn::Or(hole, hn::Or(beside, hn::Lt(range, hn::Neg(range_error))));
  const M inside = hn::And(hn::And(hn::Gt(u, margin), hn::Gt(v, margin)), hn::Gt(w, margin));
  const M sharp = hn::And(hn::Gt(range, range_error), hn::Lt(range_error, constant(GridRay::kSharp_m)));
  const V decided =
      hn::IfThenElse(hn::And(inside, sharp), range, constant(std::numeric_limits<double>::quiet_NaN()));
  return hn::IfThenElse(miss, constant(std::numeric_limits<double>::infinity()), decided);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
