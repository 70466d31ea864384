// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>

#include "hazards/lane_input.h"
#include "hazards/measure_rows.h"
#include "hazards/reach.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hazards/plane.cpp"
#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

constexpr std::size_t kPlaces = hn::MaxLanes(D());

/// Calls each(dr, dc, values at kPlaces neighbours) for the bins under the bodies, row by row.
template <class Each>
HWY_INLINE void ForBody(const PlaneInput& in, std::int64_t row, std::int64_t col, const Each& each) {
  for (std::int64_t r = -in.body.half_bins(); r <= in.body.half_bins(); ++r) {
    const std::int64_t half_width = in.body.half_width(r);
    const double* z = in.z.at(row + r, col - half_width);
    for (std::int64_t c = -half_width; c <= half_width; ++c, ++z)
      each(constant(static_cast<double>(r)), constant(static_cast<double>(c)), hn::LoadU(D(), z));
  }
}

void MeasureGroup(const PlaneInput& in, std::int64_t row, std::int64_t col,
                  std::array<double, kPlaces>& slope, std::array<double, kPlaces>& roughness) {
  const V base = hn::LoadU(D(), in.z.at(row, col));  // of each place, so that sums keep their digits
  V sum = hn::Zero(D());
  V sum_east = hn::Zero(D());
  V sum_north = hn::Zero(D());
  ForBody(in, row, col, [&](V r, V c, V z) HWY_ATTR {
    const V dz = hn::Sub(z, base);
    sum = hn::Add(sum, dz);
    sum_east = hn::Add(sum_east, hn::Mul(dz, c));
    sum_north = hn::Add(sum_north, hn::Mul(dz, r));
  });
  const V east = hn::Div(sum_east, constant(in.square));
  const V north = hn::Div(sum_north, constant(in.square));
  const V mean = hn::Add(base, hn::Div(sum, constant(in.count)));
  V most = hn::Zero(D());
  ForBody(in, row, col, [&](V r, V c, V z) HWY_ATTR {
    const V plane = hn::Add(hn::Add(mean, hn::Mul(north, r)), hn::Mul(east, c));
    most = hn::Max(most, hn::Abs(hn::Sub(z, plane)));
  });
  const V cell = constant(in.resolution_m * in.resolution_m);
  const V square = hn::Div(hn::Add(hn::Mul(east, east), hn::Mul(north, north)), cell);
  hn::StoreU(square, D(), slope.data());
  hn::StoreU(hn::Div(most, hn::Sqrt(hn::Add(constant(1), square))), D(), roughness.data());
}

void MeasurePlaneRows(const PlaneInput& in, std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
  for (std::int64_t row = begin; row < end; ++row) {
    const auto wanted = in.places.row(row);
    for (std::size_t col = 0; col < wanted.size(); col += kPlaces) {
      const auto group = wanted.subspan(col, std::min(kPlaces, wanted.size() - col));
      if (std::ranges::find(group, 1) == group.end()) continue;
      std::array<double, kPlaces> slope;
      std::array<double, kPlaces> roughness;
      MeasureGroup(in, row, static_cast<std::int64_t>(col), slope, roughness);
      for (std::size_t i = 0; i < group.size(); ++i)
        if (group[i] != 0) {
          result.slope_deg.row(row)[col + i] = slope_deg(std::sqrt(slope[i]));
          result.roughness_m.row(row)[col + i] = roughness[i];
        }
    }
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(MeasurePlaneRows);

PlaceMeasures measure_plane(const Grid<double>& z, const LanderStencil& lander, const BinMask& places,
                            const ProgressCallback& progress) {
  const GridSpec& spec = z.spec();
  const Reach reach = Reach::of_body(lander);
  const PaddedMap padded(z, reach.bins());
  const BinMask known = reach.known(padded, places);
  const PlaneInput input{padded,
                         lander.body,
                         lander.resolution_m,
                         static_cast<double>(lander.body.bin_count()),
                         static_cast<double>(lander.body.squared_offsets()),
                         known};
  return measure_rows(
      spec,
      [&](std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
        HWY_DYNAMIC_DISPATCH(MeasurePlaneRows)(input, begin, end, result);
      },
      progress);
}

}  // namespace landfall
#endif
