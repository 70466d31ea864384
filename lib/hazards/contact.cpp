// SPDX-License-Identifier: GPL-3.0-or-later
// Every plane of every yaw is compared with all bins under the body twice: in float lanes, with a bound on
// the error, which leaves a plane or two of a place that can have the largest roughness, and these in double.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "base/parallel.h"
#include "hazards/lane_input.h"
#include "hazards/measure_rows.h"
#include "hazards/reach.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hazards/contact.cpp"
#include "base/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

using F = hn::CappedTag<float, PaddedMap::kLanes>;
using VF = hn::Vec<F>;

constexpr std::size_t kPlaces = hn::MaxLanes(F());            ///< in one group, neighbours in a row
constexpr std::size_t kHalves = kPlaces / hn::MaxLanes(D());  ///< vectors of doubles of a group
constexpr std::size_t kPlanesAtOnce = 6;                      ///< that share each load of an elevation

template <class T>
using AtPlaces = std::array<T, kPlaces>;

/// A plane z = height + east dc + north dr about each place of a group; dc, dr in bins.
struct Plane {
  alignas(64) AtPlaces<double> east, north, height, cosine;
};

/// The same, in float and relative to a base.
struct RoughPlane {
  alignas(64) AtPlaces<float> east, north, height, cosine;
};

/// Of one row of places, group by group.
class ContactLanes {
 public:
  explicit ContactLanes(const ContactInput& input)
      : in_(input),
        body_(input.lander.body),
        plane_count_(input.lander.yaws.size() * (input.lander.legs == 4 ? 2 : 1)),
        planes_(plane_count_),
        rough_planes_((plane_count_ + kPlanesAtOnce - 1) / kPlanesAtOnce * kPlanesAtOnce),
        rough_(rough_planes_.size()),
        rises_(static_cast<std::size_t>(2 * body_.half_bins() + 1) * kPlanesAtOnce),
        patch_pitch_((static_cast<std::size_t>(2 * body_.half_bins()) / kPlaces + 2) * kPlaces),
        patch_(patch_pitch_ * static_cast<std::size_t>(2 * body_.half_bins() + 1)) {}

  void MeasureRow(std::int64_t row, PlaceMeasures& result) {
    const auto wanted = in_.places.row(row);
    for (std::size_t col = 0; col < wanted.size(); col += kPlaces) {
      const std::size_t end = std::min(col + kPlaces, wanted.size());
      const auto begin_of = wanted.begin() + static_cast<std::ptrdiff_t>(col);
      const auto first = std::find(begin_of, wanted.begin() + static_cast<std::ptrdiff_t>(end), 1);
      const auto at = static_cast<std::size_t>(first - wanted.begin());
      if (at == end) continue;
      const AtPlaces<double> slope = FindPlanes(row, static_cast<std::int64_t>(col));
      const AtPlaces<double> roughness =
          Roughness(row, static_cast<std::int64_t>(col), static_cast<std::int64_t>(at));
      for (std::size_t c = col; c < end; ++c)
        if (wanted[c] != 0) {
          result.slope_deg.row(row)[c] = slope_deg(std::sqrt(slope[c - col]) / in_.lander.resolution_m);
          result.roughness_m.row(row)[c] = roughness[c - col];
        }
    }
  }

 private:
  /// Fills planes_. Returns the largest squared gradient, in metres per bin.
  AtPlaces<double> FindPlanes(std::int64_t row, std::int64_t col) {
    AtPlaces<double> steepest{};
    for (std::size_t half = 0; half < kHalves; ++half) {
      const std::size_t lane = half * hn::MaxLanes(D());
      V most = hn::Zero(D());
      std::size_t plane = 0;
      for (const PadOffsets& pads : in_.lander.yaws) {
        std::array<V, 4> height;
        for (int leg = 0; leg < in_.lander.legs; ++leg) {
          const BinOffset& pad = pads[static_cast<std::size_t>(leg)];
          height[static_cast<std::size_t>(leg)] = hn::LoadU(
              D(), in_.pad_heights.at(row + pad.rows, col + pad.cols + static_cast<std::int64_t>(lane)));
        }
        if (in_.lander.legs == 4) {
          StandOnFour(pads[0], height, lane, plane, most);
          plane += 2;
        } else {
          StandOnThree(pads, height, lane, plane++, most);
        }
      }
      hn::StoreU(most, D(), steepest.data() + lane);
    }
    return steepest;
  }

  void StandOnThree(const PadOffsets& pads, const std::array<V, 4>& height, std::size_t lane,
                    std::size_t plane, V& most) {
    const auto x = [&](std::size_t leg) { return static_cast<double>(pads[leg].cols - pads[0].cols); };
    const auto y = [&](std::size_t leg) { return static_cast<double>(pads[leg].rows - pads[0].rows); };
    const V determinant = constant(x(1) * y(2) - x(2) * y(1));
    const V rise_1 = hn::Sub(height[1], height[0]);
    const V rise_2 = hn::Sub(height[2], height[0]);
    const V east =
        hn::Div(hn::Sub(hn::Mul(rise_1, constant(y(2))), hn::Mul(rise_2, constant(y(1)))), determinant);
    const V north =
        hn::Div(hn::Sub(hn::Mul(rise_2, constant(x(1))), hn::Mul(rise_1, constant(x(2)))), determinant);
    const V to_centre = hn::Add(hn::Mul(east, constant(static_cast<double>(pads[0].cols))),
                                hn::Mul(north, constant(static_cast<double>(pads[0].rows))));
    Store(east, north, hn::Sub(height[0], to_centre), lane, plane, most);
  }

  /// Two planes. Leg 1 is leg 0 turned by a quarter; the legs opposite lie opposite.
  void StandOnFour(const BinOffset& pad, const std::array<V, 4>& height, std::size_t lane, std::size_t plane,
                   V& most) {
    const V half = constant(0.5);
    const V mean_02 = hn::Mul(half, hn::Add(height[0], height[2]));
    const V mean_13 = hn::Mul(half, hn::Add(height[1], height[3]));
    const M on_02 = hn::Ge(mean_02, mean_13);
    const V centre = hn::IfThenElse(on_02, mean_02, mean_13);
    // Rises from the centre to leg 0 and to leg 1, in both planes.
    const V along_02 = hn::Mul(half, hn::Sub(height[0], height[2]));
    const V along_13 = hn::Mul(half, hn::Sub(height[1], height[3]));
    for (std::size_t way = 0; way < 2; ++way) {
      const V to_0 =
          hn::IfThenElse(on_02, along_02, way == 0 ? hn::Sub(height[0], centre) : hn::Sub(centre, height[2]));
      const V to_1 =
          hn::IfThenElse(on_02, way == 0 ? hn::Sub(height[1], centre) : hn::Sub(centre, height[3]), along_13);
      const V x = constant(static_cast<double>(pad.cols));
      const V y = constant(static_cast<double>(pad.rows));
      const V square = constant(static_cast<double>(pad.cols * pad.cols + pad.rows * pad.rows));
      const V east = hn::Div(hn::Sub(hn::Mul(to_0, x), hn::Mul(to_1, y)), square);
      const V north = hn::Div(hn::Add(hn::Mul(to_0, y), hn::Mul(to_1, x)), square);
      Store(east, north, centre, lane, plane + way, most);
    }
  }

  void Store(V east, V north, V height, std::size_t lane, std::size_t plane, V& most) {
    const V square = hn::Add(hn::Mul(east, east), hn::Mul(north, north));
    most = hn::Max(most, square);
    const double cell = in_.lander.resolution_m * in_.lander.resolution_m;
    const V cosine = hn::Div(constant(1), hn::Sqrt(hn::Add(constant(1), hn::Div(square, constant(cell)))));
    Plane& p = planes_[plane];
    hn::StoreU(east, D(), p.east.data() + lane);
    hn::StoreU(north, D(), p.north.data() + lane);
    hn::StoreU(height, D(), p.height.data() + lane);
    hn::StoreU(cosine, D(), p.cosine.data() + lane);
  }

  AtPlaces<double> Roughness(std::int64_t row, std::int64_t col, std::int64_t first_wanted) {
    const double base = *in_.z.at(row, first_wanted);
    const float most = FillPatch(row, col, base);
    MakeRoughPlanes(base);
    for (std::size_t plane = 0; plane < rough_planes_.size(); plane += kPlanesAtOnce) RoughenPlanes(plane);
    const AtPlaces<float> least = LeastOfCandidates(most);
    AtPlaces<double> roughness;
    for (std::size_t half = 0; half < kHalves; ++half)
      Refine(row, col, half * hn::MaxLanes(D()), least, roughness);
    return roughness;
  }

  /// The elevations under the bodies, less base, in float. Returns the largest magnitude.
  float FillPatch(std::int64_t row, std::int64_t col, double base) {
    const F f;
    const hn::Rebind<float, D> half;
    const std::int64_t reach = body_.half_bins();
    VF most = hn::Zero(f);
    for (std::int64_t r = -reach; r <= reach; ++r) {
      const double* const from = in_.z.at(row + r, col - reach);
      float* const to = &patch_[static_cast<std::size_t>(r + reach) * patch_pitch_];
      for (std::size_t c = 0; c < patch_pitch_; c += kPlaces) {
        for (std::size_t i = 0; i < kPlaces; i += hn::MaxLanes(D()))
          hn::StoreU(hn::DemoteTo(half, hn::Sub(hn::LoadU(D(), from + c + i), constant(base))), half,
                     to + c + i);
        const VF magnitude = hn::Abs(hn::LoadU(f, to + c));
        most = hn::IfThenElse(hn::Gt(magnitude, most), magnitude, most);  // NaN: as it was
      }
    }
    return hn::GetLane(hn::MaxOfLanes(f, most));
  }

  void MakeRoughPlanes(double base) {
    for (std::size_t plane = 0; plane < rough_planes_.size(); ++plane) {
      const Plane& exact = planes_[std::min(plane, plane_count_ - 1)];
      RoughPlane& rough = rough_planes_[plane];
      for (std::size_t i = 0; i < kPlaces; ++i) {
        rough.east[i] = static_cast<float>(exact.east[i]);
        rough.north[i] = static_cast<float>(exact.north[i]);
        rough.height[i] = static_cast<float>(exact.height[i] - base);
        rough.cosine[i] = static_cast<float>(exact.cosine[i]);
      }
    }
  }

  /// The roughness of kPlanesAtOnce planes in float.
  void RoughenPlanes(std::size_t plane) {
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
    for (std::int64_t r = -reach; r <= reach; ++r) {
      VF m0 = lowest, m1 = lowest, m2 = lowest, m3 = lowest, m4 = lowest, m5 = lowest;
      const std::int64_t half_width = body_.half_width(r);
      const auto first = static_cast<std::size_t>(reach - half_width);
      const float* z = &patch_[static_cast<std::size_t>(r + reach) * patch_pitch_ + first];
      const Rough* rise = &rises_[first * kPlanesAtOnce];
      for (const float* const end = z + 2 * half_width + 1; z != end; ++z, rise += kPlanesAtOnce) {
        const VF here = hn::LoadU(f, z);
        m0 = hn::Max(m0, hn::Sub(here, hn::Load(f, rise[0].data())));
        m1 = hn::Max(m1, hn::Sub(here, hn::Load(f, rise[1].data())));
        m2 = hn::Max(m2, hn::Sub(here, hn::Load(f, rise[2].data())));
        m3 = hn::Max(m3, hn::Sub(here, hn::Load(f, rise[3].data())));
        m4 = hn::Max(m4, hn::Sub(here, hn::Load(f, rise[4].data())));
        m5 = hn::Max(m5, hn::Sub(here, hn::Load(f, rise[5].data())));
      }
      const VF north = hn::Set(f, static_cast<float>(r));
      all0 = hn::Max(all0, hn::NegMulAdd(hn::Load(f, p[0].north.data()), north, m0));
      all1 = hn::Max(all1, hn::NegMulAdd(hn::Load(f, p[1].north.data()), north, m1));
      all2 = hn::Max(all2, hn::NegMulAdd(hn::Load(f, p[2].north.data()), north, m2));
      all3 = hn::Max(all3, hn::NegMulAdd(hn::Load(f, p[3].north.data()), north, m3));
      all4 = hn::Max(all4, hn::NegMulAdd(hn::Load(f, p[4].north.data()), north, m4));
      all5 = hn::Max(all5, hn::NegMulAdd(hn::Load(f, p[5].north.data()), north, m5));
    }
    const auto store = [&](std::size_t i, VF highest) {
      const VF above = hn::Sub(highest, hn::Load(f, p[i].height.data()));
      hn::Store(hn::Mul(above, hn::Load(f, p[i].cosine.data())), f, rough_[plane + i].data());
    };
    store(0, all0);
    store(1, all1);
    store(2, all2);
    store(3, all3);
    store(4, all4);
    store(5, all5);
  }

  /// The least roughness in float of a plane that may have the largest in double. With u = 2^-24 and
  /// magnitudes Z of the elevations and G of a plane at the body's edge, eight roundings of at most u (Z + G)
  /// part the two; 12 leaves room for the rounding of the bound itself.
  AtPlaces<float> LeastOfCandidates(float most_z) const {
    const auto reach = static_cast<float>(body_.half_bins());
    AtPlaces<float> largest;
    AtPlaces<float> plane{};
    largest.fill(-std::numeric_limits<float>::infinity());
    for (std::size_t i = 0; i < plane_count_; ++i) {
      const RoughPlane& p = rough_planes_[i];
      for (std::size_t k = 0; k < kPlaces; ++k) {
        largest[k] = std::max(largest[k], rough_[i][k]);
        plane[k] =
            std::max(plane[k], (std::abs(p.east[k]) + std::abs(p.north[k])) * reach + std::abs(p.height[k]));
      }
    }
    for (std::size_t k = 0; k < kPlaces; ++k) largest[k] -= 2 * 12 * 0x1p-24F * (most_z + plane[k]);
    return largest;
  }

  /// The largest roughness of the candidates of the places from `lane` on, in double.
  void Refine(std::int64_t row, std::int64_t col, std::size_t lane, const AtPlaces<float>& least,
              AtPlaces<double>& roughness) {
    constexpr std::size_t kLanes = hn::MaxLanes(D());
    std::array<std::size_t, kLanes> next{};  // plane from which each place looks for its next candidate
    V most = constant(-std::numeric_limits<double>::infinity());
    Plane chosen;
    std::array<bool, kLanes> has_any{};
    for (;;) {
      bool is_any = false;
      for (std::size_t i = 0; i < kLanes; ++i) {
        const std::size_t k = lane + i;
        // Without a further candidate the last one is judged again. !(<): NaN, beyond float, is a candidate.
        while (next[i] < plane_count_ &&
               (rough_[next[i]][k] < least[k] || (has_any[i] && IsChosen(next[i], k, chosen, i))))
          ++next[i];
        if (next[i] == plane_count_ && has_any[i]) continue;
        const std::size_t plane = std::min(next[i], plane_count_ - 1);
        chosen.east[i] = planes_[plane].east[k];
        chosen.north[i] = planes_[plane].north[k];
        chosen.height[i] = planes_[plane].height[k];
        chosen.cosine[i] = planes_[plane].cosine[k];
        is_any = is_any || next[i] < plane_count_;
        has_any[i] = true;
        next[i] = std::min(next[i] + 1, plane_count_);
      }
      if (!is_any) break;
      most = hn::Max(most, RoughnessOf(row, col + static_cast<std::int64_t>(lane), chosen));
    }
    hn::StoreU(most, D(), roughness.data() + lane);
  }

  [[nodiscard]] bool IsChosen(std::size_t plane, std::size_t k, const Plane& chosen, std::size_t i) const {
    const Plane& p = planes_[plane];
    return p.east[k] == chosen.east[i] && p.north[k] == chosen.north[i] && p.height[k] == chosen.height[i];
  }

  [[nodiscard]] V RoughnessOf(std::int64_t row, std::int64_t col, const Plane& plane) const {
    const D d;
    const V east = hn::Load(d, plane.east.data());
    const V north = hn::Load(d, plane.north.data());
    V most = constant(-std::numeric_limits<double>::infinity());
    for (std::int64_t r = -body_.half_bins(); r <= body_.half_bins(); ++r) {
      const V in_row =
          hn::Add(hn::Load(d, plane.height.data()), hn::Mul(north, constant(static_cast<double>(r))));
      const std::int64_t half_width = body_.half_width(r);
      const double* z = in_.z.at(row + r, col - half_width);
      for (std::int64_t c = -half_width; c <= half_width; ++c, ++z)
        most = hn::Max(
            most, hn::Sub(hn::Sub(hn::LoadU(d, z), in_row), hn::Mul(east, constant(static_cast<double>(c)))));
    }
    return hn::Mul(most, hn::Load(d, plane.cosine.data()));
  }

  const ContactInput& in_;
  const Footprint& body_;
  std::size_t plane_count_;
  std::vector<Plane> planes_;
  std::vector<RoughPlane> rough_planes_;  ///< the last one repeated up to whole blocks
  struct alignas(64) Rough : AtPlaces<float> {};
  std::vector<Rough> rough_;  ///< of rough_planes_
  std::vector<Rough> rises_;  ///< of kPlanesAtOnce planes, eastwards, by column under the body
  std::size_t patch_pitch_;
  std::vector<float> patch_;
};

void MeasureContactRows(const ContactInput& input, std::int64_t begin, std::int64_t end,
                        PlaceMeasures& result) {
  ContactLanes lanes(input);
  for (std::int64_t row = begin; row < end; ++row) lanes.MeasureRow(row, result);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {
namespace {

/// The height of the ground under a pad in each bin; without meaning where a bin under it is missing.
PaddedMap pad_heights_of(const PaddedMap& z, const GridSpec& spec, const LanderStencil& lander) {
  PaddedMap heights(spec, z.margin());
  const Footprint& pad = lander.pad;
  const auto count = static_cast<double>(pad.bin_count());
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
      double* const target = heights.at(row, 0);
      const bool is_max = lander.pad_height == PadHeight::max;
      std::fill_n(target, spec.cols, is_max ? -std::numeric_limits<double>::infinity() : 0);
      for (std::int64_t r = -pad.half_bins(); r <= pad.half_bins(); ++r)
        for (std::int64_t c = -pad.half_width(r); c <= pad.half_width(r); ++c) {
          const double* const values = z.at(row + r, c);
          if (is_max)
            for (std::int64_t k = 0; k < spec.cols; ++k) target[k] = std::max(target[k], values[k]);
          else
            for (std::int64_t k = 0; k < spec.cols; ++k) target[k] += values[k];
        }
      if (!is_max)
        for (std::int64_t k = 0; k < spec.cols; ++k) target[k] /= count;
    }
  });
  return heights;
}

}  // namespace

HWY_EXPORT(MeasureContactRows);

PlaceMeasures measure_contact(const Grid<double>& z, const LanderStencil& lander, const BinMask& places,
                              const ProgressCallback& progress) {
  const GridSpec& spec = z.spec();
  const Reach reach = Reach::of_contact(lander);
  const PaddedMap padded(z, reach.bins());
  const BinMask known = reach.known(padded, places);
  const PaddedMap pad_heights = pad_heights_of(padded, spec, lander);
  const ContactInput input{padded, pad_heights, lander, known};
  return measure_rows(
      spec,
      [&](std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
        HWY_DYNAMIC_DISPATCH(MeasureContactRows)(input, begin, end, result);
      },
      progress);
}

}  // namespace landfall
#endif
