// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/lane_input.h"
#include "chain/hazards/measure_rows.h"
#include "chain/hazards/reach.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/hazards/plane.cpp"
#include "base/numerics/lanes-inl.h"
#include "chain/hazards/body_plane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

LanePlane LeastSquares(const PlaneInput& in, std::int64_t row, std::int64_t col) {
  const V base = hn::LoadU(D(), in.terrain.z.at(row, col));  // of each place, so that sums keep their digits
  V sum = hn::Zero(D());
  V sum_east = hn::Zero(D());
  V sum_north = hn::Zero(D());
  ForBody(in.terrain, row, col, [&](V r, V c, V z) HWY_ATTR {
    const V dz = hn::Sub(z, base);
    sum = hn::Add(sum, dz);
    sum_east = hn::Add(sum_east, hn::Mul(dz, c));
    sum_north = hn::Add(sum_north, hn::Mul(dz, r));
  });
  return {hn::Div(sum_east, constant(in.square)), hn::Div(sum_north, constant(in.square)),
          hn::Add(base, hn::Div(sum, constant(in.count)))};
}

void MeasurePlaneRows(const PlaneInput& in, std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
  MeasureBodyRows(
      in.terrain, begin, end,
      [&](std::int64_t row, std::int64_t col) HWY_ATTR { return LeastSquares(in, row, col); }, result);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(MeasurePlaneRows);

PlaceMeasures measure_plane(const Grid<double>& z, const LanderStencil& lander, const BinMask& places,
                            const ProgressCallback& progress) {
  const Reach reach = Reach::of_body(lander);
  const PaddedMap padded(z, reach.bins());
  const BinMask known = reach.known(padded, places);
  const PlaneInput input{{padded, lander.body, lander.resolution_m, known},
                         static_cast<double>(lander.body.bin_count()),
                         static_cast<double>(lander.body.squared_offsets())};
  return measure_rows(
      z.spec(),
      [&](std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
        HWY_DYNAMIC_DISPATCH(MeasurePlaneRows)(input, begin, end, result);
      },
      progress);
}

}  // namespace landfall
#endif
