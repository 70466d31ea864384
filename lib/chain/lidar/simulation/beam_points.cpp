// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/beam_points.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/lidar/simulation/beam_points.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Beams in columns, few enough to stay in the first-level cache.
struct BeamBlock {
  static constexpr std::size_t kBeams = 64;
  alignas(64) std::array<std::array<double, kBeams>, 3> exit;
  alignas(64) std::array<std::array<double, kBeams>, 3> direction;
};

/// Points of the first beams in whole vectors. Returns how many.
std::size_t PointsOfBeams(const Transform<DemFrame, LidarFrame>& T, std::int64_t left_rows,
                          std::span<const Beam> beams, const double* ranges_m, const PointsOut& out) {
  const std::size_t whole = beams.size() / hn::Lanes(D()) * hn::Lanes(D());
  const std::array columns = {out.x, out.y, out.z};
  BeamBlock block;
  for (std::size_t begin = 0; begin < whole; begin += BeamBlock::kBeams) {
    const std::size_t count = std::min(BeamBlock::kBeams, whole - begin);
    for (std::size_t i = 0; i < count; ++i) {
      const Beam& beam = beams[begin + i];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block.exit[axis][i] = beam.exit.v[static_cast<Eigen::Index>(axis)];
        block.direction[axis][i] = beam.direction.v[static_cast<Eigen::Index>(axis)];
      }
    }
    for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
      const V range = hn::LoadU(D(), ranges_m + begin + i);
      const auto along = [&](std::size_t axis) HWY_ATTR {
        return hn::Add(hn::Load(D(), block.exit[axis].data() + i),
                       hn::Mul(range, hn::Load(D(), block.direction[axis].data() + i)));
      };
      const V x = along(0);
      const V y = along(1);
      const V z = along(2);
      for (Eigen::Index row = 0; row < 3; ++row) {
        const V a = hn::Mul(constant(T.rotation.m(row, 0)), x);
        const V b = hn::Mul(constant(T.rotation.m(row, 1)), y);
        const V c = hn::Mul(constant(T.rotation.m(row, 2)), z);
        const V sum = (left_rows >> row & 1) != 0 ? hn::Add(hn::Add(a, b), c) : hn::Add(a, hn::Add(b, c));
        hn::StoreU(hn::Add(sum, constant(T.position.v(row))), D(),
                   columns[static_cast<std::size_t>(row)] + begin + i);
      }
    }
  }
  return whole;
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {
namespace {

/// A point, turned by a matrix of three equal rows.
Eigen::Vector3d transformed_rows(const Eigen::RowVector3d& row, const Eigen::Vector3d& point) {
  Transform<DemFrame, LidarFrame> probe;
  probe.rotation.m.rowwise() = row;
  return (probe * Point<LidarFrame>{point}).v;
}

}  // namespace

HWY_EXPORT(PointsOfBeams);

std::optional<std::int64_t> rows_added_from_left() {
  const double small = 0x1p-53;
  const double inexact = 1 + 0x1p-30;  // its square is not a double
  const double square = inexact * inexact;
  const Eigen::Vector3d sums =
      transformed_rows({-1, 1, small}, {1, 1, 1});  // 2^-53 from the left, 0 from the right
  const Eigen::Vector3d second = transformed_rows({-square, inexact, 0}, {1, inexact, 1});  // 0 if not fused
  const Eigen::Vector3d third = transformed_rows({-square, 0, inexact}, {1, 1, inexact});
  std::int64_t rows = 0;
  for (Eigen::Index row = 0; row < 3; ++row) {
    if ((sums(row) != small && sums(row) != 0) || second(row) != 0 || third(row) != 0) return std::nullopt;
    if (sums(row) == small) rows |= std::int64_t{1} << row;
  }
  return rows;
}

void beam_points(const Transform<DemFrame, LidarFrame>& T_dem_lidar, std::span<const Beam> beams,
                 std::span<const double> ranges_m, const PointsOut& out) {
  static const std::optional<std::int64_t> left_rows = rows_added_from_left();
  const std::size_t per_beam = ranges_m.size() / beams.size();
  std::size_t done = 0;
  if (left_rows && per_beam == 1)
    done = HWY_DYNAMIC_DISPATCH(PointsOfBeams)(T_dem_lidar, *left_rows, beams, ranges_m.data(), out);
  for (std::size_t k = done; k < ranges_m.size(); ++k) {
    const Beam& beam = beams[k / per_beam];
    const Point<DemFrame> point = T_dem_lidar * (beam.exit + ranges_m[k] * beam.direction);
    out.x[k] = point.v.x();
    out.y[k] = point.v.y();
    out.z[k] = point.v.z();
  }
}

}  // namespace landfall
#endif
