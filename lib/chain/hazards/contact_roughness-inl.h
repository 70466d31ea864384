// SPDX-License-Identifier: GPL-3.0-or-later
// The largest roughness of many planes over many bins is found by bounds, in float lanes. The highest bins of
// small squares bound the roughness of a plane; the planes that can have the largest
// one are compared with the bins of the squares that can hold it, which leaves a plane or two; and these are
// compared with all bins in double. In a source that is compiled once for each instruction set.
#if defined(LANDFALL_HAZARDS_CONTACT_ROUGHNESS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_HAZARDS_CONTACT_ROUGHNESS_INL_H_
#undef LANDFALL_HAZARDS_CONTACT_ROUGHNESS_INL_H_
#else
#define LANDFALL_HAZARDS_CONTACT_ROUGHNESS_INL_H_
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/numerics/lanes-inl.h"
#include "chain/hazards/contact_planes-inl.h"
#include "chain/hazards/lane_input.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

using F = hn::CappedTag<float, PaddedMap::kLanes>;
using VF = hn::Vec<F>;
using MF = hn::Mask<F>;

constexpr std::size_t kPlanesAtOnce = 6;  ///< that share each load of an elevation

/// The same, in float and relative to a trend.
struct RoughPlane {
  alignas(64) AtPlaces<float> east, north, height, cosine;
};

/// A plane that the elevations of a group's bins are taken relative to; base at its first place.
struct Trend {
  double base, east, north;
};

/// A bin by its offset from a place.
struct Bin {
  BinOffset offset;
  float row, col;        ///< the same
  std::size_t in_patch;  ///< where the patch has the bin of the first place of a group
};

/// The part of a square of kSide bins that lies in the body.
struct BodyTile {
  Bin corner;  ///< of lowest row and column; may lie outside
  std::vector<Bin> bins;
};

constexpr std::int64_t kSide = 4;

/// Covers the body, row of tiles by row of tiles.
std::vector<std::vector<BodyTile>> cover(const Footprint& body, std::size_t patch_pitch) {
  const std::int64_t reach = body.half_bins();
  const auto bin = [&](std::int64_t row, std::int64_t col) {
    return Bin{{row, col},
               static_cast<float>(row),
               static_cast<float>(col),
               static_cast<std::size_t>(row + reach) * patch_pitch + static_cast<std::size_t>(col + reach)};
  };
  std::vector<std::vector<BodyTile>> rows;
  for (std::int64_t row = -reach; row <= reach; row += kSide) {
    rows.emplace_back();
    for (std::int64_t col = -reach; col <= reach; col += kSide) {
      BodyTile tile{bin(row, col), {}};
      for (std::int64_t r = row; r < std::min(row + kSide, reach + 1); ++r)
        for (std::int64_t c = col; c < col + kSide; ++c)
          if (std::abs(c) <= body.half_width(r)) tile.bins.push_back(bin(r, c));
      if (!tile.bins.empty()) rows.back().push_back(std::move(tile));
    }
  }
  return rows;
}

/// Measures the contact roughness of one group of places at a time.
class ContactRoughness {
 public:
  ContactRoughness(const ContactInput& input, const std::vector<Plane>& planes)
      : in_(input),
        body_(input.lander.body),
        planes_(planes),
        rough_planes_((planes.size() + kPlanesAtOnce - 1) / kPlanesAtOnce * kPlanesAtOnce),
        max_(rough_planes_.size()),
        rises_(static_cast<std::size_t>(2 * body_.half_bins() + 1) * kPlanesAtOnce),
        patch_pitch_((static_cast<std::size_t>(2 * body_.half_bins()) / kContactPlaces + 2) * kContactPlaces),
        patch_(patch_pitch_ * static_cast<std::size_t>(2 * body_.half_bins() + 1)),
        cover_(cover(body_, patch_pitch_)) {
    for (const std::vector<BodyTile>& tiles : cover_) tops_.resize(tops_.size() + tiles.size());
  }

  /// The largest roughness of the planes at each wanted place of the group from (row, col) on; the first of
  /// them is number first_wanted.
  AtPlaces<double> Largest(std::int64_t row, std::int64_t col, std::size_t first_wanted,
                           const AtPlaces<std::int8_t>& is_wanted) {
    const Trend trend = TrendAt(row, col, first_wanted);
    const float max_z = FillPatch(row, col, trend);
    const float max_plane = MakeRoughPlanes(trend, is_wanted);
    FindTops();
    for (std::size_t plane = 0; plane < rough_planes_.size(); plane += kPlanesAtOnce) BoundPlanes(plane);
    return LargestRoughness(row, col, 2 * RoughError(max_z, max_plane, trend), is_wanted);
  }

 private:
  /// The mean plane of a place.
  [[nodiscard]] Trend TrendAt(std::int64_t row, std::int64_t col, std::size_t place) const {
    Trend trend{*in_.z.at(row, col + static_cast<std::int64_t>(place)), 0, 0};
    for (const Plane& plane : planes_) {
      trend.east += plane.east[place] / static_cast<double>(planes_.size());
      trend.north += plane.north[place] / static_cast<double>(planes_.size());
    }
    return trend;
  }

  /// The elevations under the bodies, less the trend, in float; missing ones are low. Returns the largest
  /// magnitude.
  float FillPatch(std::int64_t row, std::int64_t col, const Trend& trend) {
    const D d;
    const F f;
    const hn::Rebind<float, D> half;
    const std::int64_t reach = body_.half_bins();
    const V east = constant(trend.east);
    const VF missing = hn::Set(f, -std::numeric_limits<float>::infinity());
    VF maximum = hn::Zero(f);
    for (std::int64_t r = -reach; r <= reach; ++r) {
      const double* const from = in_.z.at(row + r, col - reach);
      float* const to = &patch_[static_cast<std::size_t>(r + reach) * patch_pitch_];
      const V in_row = constant(trend.base + trend.north * static_cast<double>(r));
      for (std::size_t c = 0; c < patch_pitch_; c += kContactPlaces) {
        for (std::size_t i = c; i < c + kContactPlaces; i += hn::MaxLanes(d)) {
          const V rise = hn::Mul(east, hn::Iota(d, static_cast<double>(i) - static_cast<double>(reach)));
          hn::StoreU(hn::DemoteTo(half, hn::Sub(hn::Sub(hn::LoadU(d, from + i), in_row), rise)), half,
                     to + i);
        }
        const VF z = hn::LoadU(f, to + c);
        const MF is_known = hn::Eq(z, z);
        hn::StoreU(hn::IfThenElse(is_known, z, missing), f, to + c);
        maximum = hn::IfThenElse(is_known, hn::Max(hn::Abs(z), maximum), maximum);
      }
    }
    return hn::GetLane(hn::MaxOfLanes(f, maximum));
  }

  /// The highest bin of each tile.
  void FindTops() {
    const F f;
    std::size_t next = 0;
    for (const std::vector<BodyTile>& tiles : cover_)
      for (const BodyTile& tile : tiles) {
        VF top = hn::Set(f, -std::numeric_limits<float>::infinity());
        for (const Bin& bin : tile.bins) top = hn::Max(top, hn::LoadU(f, &patch_[bin.in_patch]));
        hn::Store(top, f, tops_[next++].data());
      }
  }

  /// Returns the largest magnitude of a plane in the tiles of a body. Planes that are the one before again
  /// are infinitely high.
  float MakeRoughPlanes(const Trend& trend, const AtPlaces<std::int8_t>& is_wanted) {
    const D d;
    const F f;
    const hn::Rebind<float, D> half;
    const double cell = in_.lander.resolution_m * in_.lander.resolution_m;
    const VF reach = hn::Set(f, static_cast<float>(body_.half_bins() + kSide));
    VF maximum = hn::Zero(f);
    for (std::size_t plane = 0; plane < rough_planes_.size(); ++plane) {
      const Plane& exact = planes_[std::min(plane, planes_.size() - 1)];
      const Plane& before = planes_[std::min(std::max<std::size_t>(plane, 1), planes_.size()) - 1];
      RoughPlane& rough = rough_planes_[plane];
      bool is_again = false;  // at some place
      for (std::size_t i = 0; i < kContactPlaces; i += hn::MaxLanes(d)) {
        const V east = hn::Load(d, &exact.east[i]);
        const V north = hn::Load(d, &exact.north[i]);
        const V height = hn::Load(d, &exact.height[i]);
        const V taken_off =
            hn::MulAdd(constant(trend.east), hn::Iota(d, static_cast<double>(i)), constant(trend.base));
        hn::Store(hn::DemoteTo(half, hn::Sub(east, constant(trend.east))), half, &rough.east[i]);
        hn::Store(hn::DemoteTo(half, hn::Sub(north, constant(trend.north))), half, &rough.north[i]);
        hn::Store(hn::DemoteTo(half, hn::Sub(height, taken_off)), half, &rough.height[i]);
        const M is_same = hn::And(hn::Eq(east, hn::Load(d, &before.east[i])),
                                  hn::Eq(height, hn::Load(d, &before.height[i])));
        is_again = is_again || !hn::AllFalse(d, is_same);
        const V square = hn::Add(hn::Mul(east, east), hn::Mul(north, north));
        hn::Store(hn::DemoteTo(half, hn::Mul(square, constant(1 / cell))), half, &rough.cosine[i]);
      }
      const VF one = hn::Set(f, 1);
      hn::Store(hn::Div(one, hn::Sqrt(hn::Add(one, hn::Load(f, rough.cosine.data())))), f,
                rough.cosine.data());
      const VF gradient =
          hn::Add(hn::Abs(hn::Load(f, rough.east.data())), hn::Abs(hn::Load(f, rough.north.data())));
      maximum = hn::Max(maximum, hn::MulAdd(gradient, reach, hn::Abs(hn::Load(f, rough.height.data()))));
      if (is_again && plane > 0)
        for (std::size_t k = 0; k < kContactPlaces; ++k)
          if (exact.east[k] == before.east[k] && exact.north[k] == before.north[k] &&
              exact.height[k] == before.height[k])
            rough.height[k] = std::numeric_limits<float>::infinity();
    }
    alignas(64) AtPlaces<float> at_edge;
    hn::Store(maximum, f, at_edge.data());
    float largest = 0;
    for (std::size_t k = 0; k < kContactPlaces; ++k)
      if (is_wanted[k] != 0) largest = std::max(largest, at_edge[k]);
    return largest;
  }

  /// How far the roughness of a plane in float may be from that in double. With u = 2^-24 and magnitudes Z of
  /// the elevations and G of a plane in the tiles, both relative to the trend, fewer than twelve
  /// roundings of at most u (Z + G) part the two, also where a tile is left out because its bound is not
  /// larger; 16 leaves room for the rounding of the bounds themselves. Of double there are fewer than 32 of
  /// 2^-53 times what the trend took off.
  [[nodiscard]] float RoughError(float max_z, float max_plane, const Trend& trend) const {
    const double taken_off = std::abs(trend.base) + (std::abs(trend.east) + std::abs(trend.north)) *
                                                        static_cast<double>(patch_pitch_);
    return 16 * 0x1p-24F * (max_z + max_plane) +
           static_cast<float>(0x1p-48 * (taken_off + static_cast<double>(max_z)));
  }

  /// Upper bounds of the roughness of kPlanesAtOnce planes, in float.
  void BoundPlanes(std::size_t plane) {
    const F f;
    const std::int64_t reach = body_.half_bins();
    const VF lowest = hn::Set(f, -std::numeric_limits<float>::infinity());
    const RoughPlane* const p = &rough_planes_[plane];
    // On many processors an addition and a maximum run side by side, a multiplication and a maximum do not.
    const std::size_t width = 2 * static_cast<std::size_t>(reach) + 1;
    for (std::size_t i = 0; i < kPlanesAtOnce; ++i)
      for (std::size_t c = 0; c < width; ++c)
        hn::Store(hn::Mul(hn::Load(f, p[i].east.data()),
                          hn::Set(f, static_cast<float>(c) - static_cast<float>(reach))),
                  f, rises_[c * kPlanesAtOnce + i].data());
    VF all0 = lowest, all1 = lowest, all2 = lowest, all3 = lowest, all4 = lowest, all5 = lowest;
    const Rough* top = tops_.data();
    for (const std::vector<BodyTile>& tiles : cover_) {
      VF m0 = lowest, m1 = lowest, m2 = lowest, m3 = lowest, m4 = lowest, m5 = lowest;
      for (const BodyTile& tile : tiles) {
        const VF here = hn::Load(f, (top++)->data());
        const Rough* const rise =
            &rises_[static_cast<std::size_t>(tile.corner.offset.cols + reach) * kPlanesAtOnce];
        m0 = hn::Max(m0, hn::Sub(here, hn::Load(f, rise[0].data())));
        m1 = hn::Max(m1, hn::Sub(here, hn::Load(f, rise[1].data())));
        m2 = hn::Max(m2, hn::Sub(here, hn::Load(f, rise[2].data())));
        m3 = hn::Max(m3, hn::Sub(here, hn::Load(f, rise[3].data())));
        m4 = hn::Max(m4, hn::Sub(here, hn::Load(f, rise[4].data())));
        m5 = hn::Max(m5, hn::Sub(here, hn::Load(f, rise[5].data())));
      }
      const VF north = hn::Set(f, tiles.front().corner.row);
      all0 = hn::Max(all0, hn::NegMulAdd(hn::Load(f, p[0].north.data()), north, m0));
      all1 = hn::Max(all1, hn::NegMulAdd(hn::Load(f, p[1].north.data()), north, m1));
      all2 = hn::Max(all2, hn::NegMulAdd(hn::Load(f, p[2].north.data()), north, m2));
      all3 = hn::Max(all3, hn::NegMulAdd(hn::Load(f, p[3].north.data()), north, m3));
      all4 = hn::Max(all4, hn::NegMulAdd(hn::Load(f, p[4].north.data()), north, m4));
      all5 = hn::Max(all5, hn::NegMulAdd(hn::Load(f, p[5].north.data()), north, m5));
    }
    const auto store = [&](std::size_t i, VF highest) {
      const VF maximum = RoughnessAt(hn::Add(highest, Fall(p[i])), p[i]);
      // Beyond float a plane is a candidate.
      hn::Store(hn::IfThenElse(hn::Eq(maximum, maximum), maximum, hn::Neg(lowest)), f,
                max_[plane + i].data());
    };
    store(0, all0);
    store(1, all1);
    store(2, all2);
    store(3, all3);
    store(4, all4);
    store(5, all5);
  }

  /// How far a plane falls, at most, from the corner of a tile on; and rises.
  [[nodiscard]] static VF Fall(const RoughPlane& plane) {
    const F f;
    const VF steepest = hn::Add(hn::Min(hn::Load(f, plane.east.data()), hn::Zero(f)),
                                hn::Min(hn::Load(f, plane.north.data()), hn::Zero(f)));
    return hn::Mul(steepest, hn::Set(f, static_cast<float>(1 - kSide)));
  }
  [[nodiscard]] static VF Rise(const RoughPlane& plane) {
    const F f;
    const VF steepest = hn::Add(hn::Max(hn::Load(f, plane.east.data()), hn::Zero(f)),
                                hn::Max(hn::Load(f, plane.north.data()), hn::Zero(f)));
    return hn::Mul(steepest, hn::Set(f, static_cast<float>(kSide - 1)));
  }

  /// The roughness of a point, from its height above the plane without the plane's own height.
  [[nodiscard]] static VF RoughnessAt(VF height, const RoughPlane& plane) {
    const F f;
    return hn::Mul(hn::Sub(height, hn::Load(f, plane.height.data())), hn::Load(f, plane.cosine.data()));
  }

  /// The largest roughness of a plane at each wanted place: the planes are taken by their upper bounds until
  /// none can have a larger one.
  [[nodiscard]] AtPlaces<double> LargestRoughness(std::int64_t row, std::int64_t col, float error_of_z,
                                                  const AtPlaces<std::int8_t>& is_wanted) {
    const F f;
    const VF lowest = hn::Set(f, -std::numeric_limits<float>::infinity());
    const VF error = hn::Set(f, error_of_z);
    alignas(64) AtPlaces<float> not_wanted{};
    for (std::size_t k = 0; k < kContactPlaces; ++k) not_wanted[k] = is_wanted[k] != 0 ? 0 : 1;
    const MF is_done = hn::Gt(hn::Load(f, not_wanted.data()), hn::Zero(f));
    VF needed = lowest;
    alignas(64) AtPlaces<double> roughness;
    roughness.fill(-std::numeric_limits<double>::infinity());
    for (std::size_t taken = 0; taken < planes_.size(); ++taken) {
      VF maximum = lowest;
      VF plane = hn::Zero(f);
      for (std::size_t i = 0; i < planes_.size(); ++i) {
        const VF bound = hn::Load(f, max_[i].data());
        const MF is_more = hn::Gt(bound, maximum);
        maximum = hn::IfThenElse(is_more, bound, maximum);
        plane = hn::IfThenElse(is_more, hn::Set(f, static_cast<float>(i)), plane);
      }
      if (hn::AllTrue(f, hn::Or(is_done, hn::Lt(maximum, needed)))) break;
      alignas(64) AtPlaces<float> number;
      hn::Store(plane, f, number.data());
      Plane exact;
      RoughPlane rough;
      for (std::size_t k = 0; k < kContactPlaces; ++k) {
        const auto i = static_cast<std::size_t>(number[k]);
        exact.east[k] = planes_[i].east[k];
        exact.north[k] = planes_[i].north[k];
        exact.height[k] = planes_[i].height[k];
        rough.east[k] = rough_planes_[i].east[k];
        rough.north[k] = rough_planes_[i].north[k];
        rough.height[k] = rough_planes_[i].height[k];
        rough.cosine[k] = rough_planes_[i].cosine[k];
        max_[i][k] = -std::numeric_limits<float>::infinity();
      }
      if (taken == 0) needed = hn::Sub(AtLeast(rough), error);
      JudgePlane({row, col}, exact, rough, needed, is_done, roughness);
      needed = hn::Max(needed, hn::Sub(Narrow(roughness), error));
    }
    return roughness;
  }

  [[nodiscard]] static VF Narrow(const AtPlaces<double>& values) {
    alignas(64) AtPlaces<float> narrow;
    for (std::size_t k = 0; k < kContactPlaces; ++k) narrow[k] = static_cast<float>(values[k]);
    return hn::Load(F(), narrow.data());
  }

  /// A lower bound of the roughness of a plane.
  [[nodiscard]] VF AtLeast(const RoughPlane& plane) const {
    const F f;
    VF highest = hn::Set(f, -std::numeric_limits<float>::infinity());
    const Rough* top = tops_.data();
    for (const std::vector<BodyTile>& tiles : cover_)
      for (const BodyTile& tile : tiles)
        highest = hn::Max(highest, Above(hn::Load(f, (top++)->data()), plane, tile.corner));
    return RoughnessAt(hn::Sub(highest, Rise(plane)), plane);
  }

  /// Elevations less the plane, whose own height is left out.
  [[nodiscard]] static VF Above(VF z, const RoughPlane& plane, const Bin& bin) {
    const F f;
    const VF in_row = hn::NegMulAdd(hn::Load(f, plane.north.data()), hn::Set(f, bin.row), z);
    return hn::NegMulAdd(hn::Load(f, plane.east.data()), hn::Set(f, bin.col), in_row);
  }

  /// Raises `roughness` to that of a plane for each place, in double, where it is at least `needed`.
  void JudgePlane(BinIndex group, const Plane& exact, const RoughPlane& rough, VF needed, MF is_done,
                  AtPlaces<double>& roughness) const {
    const D d;
    const F f;
    const VF minimum =
        hn::Add(hn::Div(needed, hn::Load(f, rough.cosine.data())), hn::Load(f, rough.height.data()));
    const VF min_top = hn::Sub(minimum, Fall(rough));
    const auto is_low = [&](VF above, VF lowest) {
      return hn::AllTrue(f, hn::Or(is_done, hn::Lt(above, lowest)));
    };
    alignas(64) AtPlaces<double> highest;
    highest.fill(-std::numeric_limits<double>::infinity());
    const Rough* top = tops_.data();
    for (const std::vector<BodyTile>& tiles : cover_)
      for (const BodyTile& tile : tiles) {
        if (is_low(Above(hn::Load(f, (top++)->data()), rough, tile.corner), min_top)) continue;
        for (const Bin& bin : tile.bins)
          if (!is_low(Above(hn::LoadU(f, &patch_[bin.in_patch]), rough, bin), minimum))
            CompareBin(group, bin.offset, exact, highest);
      }
    for (std::size_t k = 0; k < kContactPlaces; k += hn::MaxLanes(d)) {
      const V east = hn::Load(d, &exact.east[k]);
      const V north = hn::Load(d, &exact.north[k]);
      const V square = hn::Add(hn::Mul(east, east), hn::Mul(north, north));
      const V cell = constant(in_.lander.resolution_m * in_.lander.resolution_m);
      const V cosine = hn::Div(constant(1), hn::Sqrt(hn::Add(constant(1), hn::Div(square, cell))));
      const V found = hn::Mul(hn::Load(d, &highest[k]), cosine);
      hn::Store(hn::Max(hn::Load(d, &roughness[k]), found), d, &roughness[k]);
    }
  }

  /// Raises `highest` to the heights of a bin above the planes.
  void CompareBin(BinIndex group, const BinOffset& bin, const Plane& plane, AtPlaces<double>& highest) const {
    const D d;
    const double* const z = in_.z.at(group.row + bin.rows, group.col + bin.cols);
    const V rows = constant(static_cast<double>(bin.rows));
    const V cols = constant(static_cast<double>(bin.cols));
    for (std::size_t k = 0; k < kContactPlaces; k += hn::MaxLanes(d)) {
      const V in_row = hn::Add(hn::Load(d, &plane.height[k]), hn::Mul(hn::Load(d, &plane.north[k]), rows));
      const V above =
          hn::Sub(hn::Sub(hn::LoadU(d, z + k), in_row), hn::Mul(hn::Load(d, &plane.east[k]), cols));
      hn::Store(hn::Max(hn::Load(d, &highest[k]), above), d, &highest[k]);
    }
  }

  const ContactInput& in_;
  const Footprint& body_;
  const std::vector<Plane>& planes_;
  std::vector<RoughPlane> rough_planes_;  ///< of planes_, the last one repeated up to whole blocks
  struct alignas(64) Rough : AtPlaces<float> {};
  std::vector<Rough> max_;    ///< upper bounds of the roughness of rough_planes_
  std::vector<Rough> rises_;  ///< of kPlanesAtOnce planes, eastwards, by column under the body
  std::size_t patch_pitch_;
  std::vector<float> patch_;  ///< elevations under the bodies less the trend
  std::vector<std::vector<BodyTile>> cover_;
  std::vector<Rough> tops_;  ///< of the tiles of cover_
};

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // LANDFALL_HAZARDS_CONTACT_ROUGHNESS_INL_H_
