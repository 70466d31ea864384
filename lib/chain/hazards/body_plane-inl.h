// SPDX-License-Identifier: GPL-3.0-or-later
// The ground under the body against one plane of each place, for methods that fit a plane to that ground; in
// a source that is compiled once for each instruction set.
#if defined(LANDFALL_HAZARDS_BODY_PLANE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_HAZARDS_BODY_PLANE_INL_H_
#undef LANDFALL_HAZARDS_BODY_PLANE_INL_H_
#else
#define LANDFALL_HAZARDS_BODY_PLANE_INL_H_
#endif

#include <algorithm>
#include <array>

#include "base/numerics/lanes-inl.h"
#include "chain/hazards/lane_input.h"
#include "chain/hazards/measures.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

constexpr std::size_t kPlaces = hn::MaxLanes(D());

/// A plane z = height + east dc + north dr about each of kPlaces neighbours in a row; dc, dr in bins.
struct LanePlane {
  V east, north, height;
};

/// Calls each(dr, dc, values at kPlaces neighbours) for the bins under the bodies, row by row.
template <class Each>
HWY_INLINE void ForBody(const BodyInput& in, std::int64_t row, std::int64_t col, const Each& each) {
  for (std::int64_t r = -in.body.half_bins(); r <= in.body.half_bins(); ++r) {
    const std::int64_t half_width = in.body.half_width(r);
    const double* z = in.z.at(row + r, col - half_width);
    for (std::int64_t c = -half_width; c <= half_width; ++c, ++z)
      each(constant(static_cast<double>(r)), constant(static_cast<double>(c)), hn::LoadU(D(), z));
  }
}

/// Slope and largest |z - plane| cos(slope) of the places of each row; fit(row, col) gives their LanePlane.
template <class Fit>
HWY_INLINE void MeasureBodyRows(const BodyInput& in, std::int64_t begin, std::int64_t end, const Fit& fit,
                                PlaceMeasures& result) {
  const V cell = constant(in.resolution_m * in.resolution_m);
  for (std::int64_t row = begin; row < end; ++row) {
    const auto wanted = in.places.row(row);
    for (std::size_t col = 0; col < wanted.size(); col += kPlaces) {
      const auto group = wanted.subspan(col, std::min(kPlaces, wanted.size() - col));
      if (std::ranges::find(group, 1) == group.end()) continue;
      const LanePlane plane = fit(row, static_cast<std::int64_t>(col));
      V maximum = hn::Zero(D());
      ForBody(in, row, static_cast<std::int64_t>(col), [&](V r, V c, V z) HWY_ATTR {
        const V on_plane = hn::Add(hn::Add(plane.height, hn::Mul(plane.north, r)), hn::Mul(plane.east, c));
        maximum = hn::Max(maximum, hn::Abs(hn::Sub(z, on_plane)));
      });
      const V square =
          hn::Div(hn::Add(hn::Mul(plane.east, plane.east), hn::Mul(plane.north, plane.north)), cell);
      std::array<double, kPlaces> gradient;
      std::array<double, kPlaces> roughness;
      hn::StoreU(hn::Sqrt(square), D(), gradient.data());
      hn::StoreU(hn::Div(maximum, hn::Sqrt(hn::Add(constant(1), square))), D(), roughness.data());
      for (std::size_t i = 0; i < group.size(); ++i)
        if (group[i] != 0) {
          result.slope_deg.row(row)[col + i] = slope_deg(gradient[i]);
          result.roughness_m.row(row)[col + i] = roughness[i];
        }
    }
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // LANDFALL_HAZARDS_BODY_PLANE_INL_H_
