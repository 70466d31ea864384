// SPDX-License-Identifier: GPL-3.0-or-later
// The planes on which a lander stands in each of its yaws, at neighbouring places; in a source that is
// compiled once for each instruction set.
#if defined(LANDFALL_HAZARDS_CONTACT_PLANES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LANDFALL_HAZARDS_CONTACT_PLANES_INL_H_
#undef LANDFALL_HAZARDS_CONTACT_PLANES_INL_H_
#else
#define LANDFALL_HAZARDS_CONTACT_PLANES_INL_H_
#endif

#include <array>
#include <vector>

#include "base/numerics/lanes-inl.h"
#include "chain/hazards/lane_input.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

constexpr std::size_t kContactPlaces =
    hn::MaxLanes(hn::CappedTag<float, PaddedMap::kLanes>());  ///< in one group, neighbours in a row

template <class T>
using AtPlaces = std::array<T, kContactPlaces>;

/// A plane z = height + east dc + north dr about each place of a group; dc, dr in bins.
struct Plane {
  alignas(64) AtPlaces<double> east, north, height;
};

/// One plane per yaw for three legs, two for four.
class ContactPlanes {
 public:
  explicit ContactPlanes(const ContactInput& input)
      : in_(input), planes_(input.lander.yaws.size() * (input.lander.legs == 4 ? 2 : 1)) {}

  /// The planes of the last group.
  [[nodiscard]] const std::vector<Plane>& planes() const { return planes_; }

  /// The planes about the kContactPlaces places from (row, col) on. Returns their largest squared gradients,
  /// in metres per bin.
  AtPlaces<double> Find(std::int64_t row, std::int64_t col) {
    AtPlaces<double> steepest{};
    for (std::size_t half = 0; half < kContactPlaces / hn::MaxLanes(D()); ++half) {
      const std::size_t lane = half * hn::MaxLanes(D());
      V maximum = hn::Zero(D());
      std::size_t plane = 0;
      for (const PadOffsets& pads : in_.lander.yaws) {
        std::array<V, 4> height;
        for (int leg = 0; leg < in_.lander.legs; ++leg) {
          const BinOffset& pad = pads[static_cast<std::size_t>(leg)];
          height[static_cast<std::size_t>(leg)] = hn::LoadU(
              D(), in_.pad_heights.at(row + pad.rows, col + pad.cols + static_cast<std::int64_t>(lane)));
        }
        if (in_.lander.legs == 4) {
          StandOnFour(pads[0], height, lane, plane, maximum);
          plane += 2;
        } else {
          StandOnThree(pads, height, lane, plane++, maximum);
        }
      }
      hn::StoreU(maximum, D(), steepest.data() + lane);
    }
    return steepest;
  }

 private:
  void StandOnThree(const PadOffsets& pads, const std::array<V, 4>& height, std::size_t lane,
                    std::size_t plane, V& maximum) {
    const auto x = [&](std::size_t leg) { return static_cast<double>(pads[leg].cols - pads[0].cols); };
    const auto y = [&](std::size_t leg) { return static_cast<double>(pads[leg].rows - pads[0].rows); };
    const V per_determinant = constant(1 / (x(1) * y(2) - x(2) * y(1)));
    const V rise_1 = hn::Sub(height[1], height[0]);
    const V rise_2 = hn::Sub(height[2], height[0]);
    const V east =
        hn::Mul(hn::Sub(hn::Mul(rise_1, constant(y(2))), hn::Mul(rise_2, constant(y(1)))), per_determinant);
    const V north =
        hn::Mul(hn::Sub(hn::Mul(rise_2, constant(x(1))), hn::Mul(rise_1, constant(x(2)))), per_determinant);
    const V to_centre = hn::Add(hn::Mul(east, constant(static_cast<double>(pads[0].cols))),
                                hn::Mul(north, constant(static_cast<double>(pads[0].rows))));
    Store(east, north, hn::Sub(height[0], to_centre), lane, plane, maximum);
  }

  /// Two planes. Leg 1 is leg 0 turned by a quarter; the legs opposite lie opposite.
  void StandOnFour(const BinOffset& pad, const std::array<V, 4>& height, std::size_t lane, std::size_t plane,
                   V& maximum) {
    const V half = constant(0.5);
    const V x = constant(static_cast<double>(pad.cols));
    const V y = constant(static_cast<double>(pad.rows));
    const V per_square = constant(1 / static_cast<double>(pad.cols * pad.cols + pad.rows * pad.rows));
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
      const V east = hn::Mul(hn::Sub(hn::Mul(to_0, x), hn::Mul(to_1, y)), per_square);
      const V north = hn::Mul(hn::Add(hn::Mul(to_0, y), hn::Mul(to_1, x)), per_square);
      Store(east, north, centre, lane, plane + way, maximum);
    }
  }

  void Store(V east, V north, V height, std::size_t lane, std::size_t plane, V& maximum) {
    const V square = hn::Add(hn::Mul(east, east), hn::Mul(north, north));
    maximum = hn::Max(maximum, square);
    Plane& p = planes_[plane];
    hn::StoreU(east, D(), p.east.data() + lane);
    hn::StoreU(north, D(), p.north.data() + lane);
    hn::StoreU(height, D(), p.height.data() + lane);
  }

  const ContactInput& in_;
  std::vector<Plane> planes_;
};

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // LANDFALL_HAZARDS_CONTACT_PLANES_INL_H_
