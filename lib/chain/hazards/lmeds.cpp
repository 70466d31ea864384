// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D287
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "base/numerics/random.h"
#include "chain/hazards/lane_input.h"
#include "chain/hazards/measure_rows.h"
#include "chain/hazards/reach.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/hazards/lmeds.cpp"
#include "base/numerics/lanes-inl.h"
#include "chain/hazards/body_plane-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

using PlaceLanes = std::array<double, kPlaces>;

/// On a grid the planes through two triples that share two bins often have equal medians: each is the misfit
/// of the other's third bin, as far from the line through both. Rounding must not choose between them.
constexpr double kMinGain_m = 1e-9;

/// Measures one group of places at a time.
class Lmeds {
 public:
  explicit Lmeds(const LmedsInput& input)
      : in_(input), heights_(input.samples.size()), misfits_(heights_.size()), of_place_(heights_.size()) {}

  LanePlane Fit(std::int64_t row, std::int64_t col) {
    const V base = hn::LoadU(D(), in_.terrain.z.at(row, col));  // of each place, so that misfits keep digits
    for (std::size_t i = 0; i < heights_.size(); ++i) {
      const BinOffset& bin = in_.samples[i];
      Store(hn::Sub(hn::LoadU(D(), in_.terrain.z.at(row + bin.rows, col + bin.cols)), base), heights_[i]);
    }
    LanePlane best{hn::Zero(D()), hn::Zero(D()), hn::Zero(D())};
    V minimum = constant(std::numeric_limits<double>::infinity());
    for (const SampleTriple& triple : in_.triples) {
      const LanePlane plane = Through(triple);
      const V below = CountBelow(plane, hn::Sub(minimum, constant(kMinGain_m)));
      // The median is below where more than half of the misfits are.
      const M is_better = hn::Gt(below, constant(static_cast<double>(heights_.size() / 2)));
      if (hn::AllFalse(D(), is_better)) continue;
      best.east = hn::IfThenElse(is_better, plane.east, best.east);
      best.north = hn::IfThenElse(is_better, plane.north, best.north);
      best.height = hn::IfThenElse(is_better, plane.height, best.height);
      minimum = Medians(is_better, minimum);
    }
    best.height = hn::Add(best.height, base);
    return best;
  }

 private:
  struct alignas(64) Lanes : PlaceLanes {};

  static V Load(const Lanes& lanes) { return hn::Load(D(), lanes.data()); }
  static void Store(V values, Lanes& lanes) { hn::Store(values, D(), lanes.data()); }

  [[nodiscard]] LanePlane Through(const SampleTriple& triple) const {
    const V first = Load(heights_[triple.samples[0]]);
    const V rise_1 = hn::Sub(Load(heights_[triple.samples[1]]), first);
    const V rise_2 = hn::Sub(Load(heights_[triple.samples[2]]), first);
    const auto gradient = [&](const std::array<double, 2>& per_rise) HWY_ATTR {
      return hn::Add(hn::Mul(rise_1, constant(per_rise[0])), hn::Mul(rise_2, constant(per_rise[1])));
    };
    const V east = gradient(triple.east);
    const V north = gradient(triple.north);
    const BinOffset& bin = in_.samples[triple.samples[0]];
    const V to_centre = hn::Add(hn::Mul(east, constant(static_cast<double>(bin.cols))),
                                hn::Mul(north, constant(static_cast<double>(bin.rows))));
    return {east, north, hn::Sub(first, to_centre)};
  }

  /// Fills misfits_. Returns how many are below `bound`.
  V CountBelow(const LanePlane& plane, V bound) {
    V count = hn::Zero(D());
    for (std::size_t i = 0; i < heights_.size(); ++i) {
      const BinOffset& bin = in_.samples[i];
      const V on_plane =
          hn::Add(hn::Add(plane.height, hn::Mul(plane.north, constant(static_cast<double>(bin.rows)))),
                  hn::Mul(plane.east, constant(static_cast<double>(bin.cols))));
      const V misfit = hn::Abs(hn::Sub(Load(heights_[i]), on_plane));
      Store(misfit, misfits_[i]);
      count = hn::Add(count, hn::IfThenElseZero(hn::Lt(misfit, bound), constant(1)));
    }
    return count;
  }

  /// The medians of the misfits where `is_better`, else `minimum`.
  V Medians(M is_better, V minimum) {
    Lanes medians;
    Lanes wanted;
    Store(minimum, medians);
    Store(hn::IfThenElseZero(is_better, constant(1)), wanted);
    const auto middle = of_place_.begin() + static_cast<std::ptrdiff_t>(of_place_.size() / 2);
    for (std::size_t k = 0; k < kPlaces; ++k) {
      if (wanted[k] == 0) continue;
      for (std::size_t i = 0; i < of_place_.size(); ++i) of_place_[i] = misfits_[i][k];
      std::ranges::nth_element(of_place_, middle);
      medians[k] = *middle;
    }
    return Load(medians);
  }

  const LmedsInput& in_;
  std::vector<Lanes> heights_;  ///< of the samples, above the place
  std::vector<Lanes> misfits_;  ///< of the samples, from the last plane
  std::vector<double> of_place_;
};

void MeasureLmedsRows(const LmedsInput& in, std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
  Lmeds median(in);
  MeasureBodyRows(
      in.terrain, begin, end,
      [&](std::int64_t row, std::int64_t col) HWY_ATTR { return median.Fit(row, col); }, result);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {
namespace {

constexpr std::size_t kTriples = 35;
constexpr std::int64_t kStridesPerRadius = 4;
constexpr std::uint64_t kSeed = 1;

/// The bins under the body whose row and column are multiples of the stride, row by row.
std::vector<BinOffset> samples_of(const Footprint& body) {
  const std::int64_t stride = std::max<std::int64_t>(1, body.half_bins() / kStridesPerRadius);
  const std::int64_t maximum = body.half_bins() / stride;
  std::vector<BinOffset> samples;
  for (std::int64_t row = -maximum; row <= maximum; ++row) {
    const std::int64_t width = body.half_width(row * stride) / stride;
    for (std::int64_t col = -width; col <= width; ++col) samples.push_back({row * stride, col * stride});
  }
  return samples;
}

/// Triples that are not in one line.
std::vector<SampleTriple> draw_triples(const std::vector<BinOffset>& samples) {
  const RandomField random(kSeed, RandomStream::lmeds);
  std::vector<SampleTriple> triples;
  for (std::uint64_t draw = 0; triples.size() < kTriples; ++draw) {
    std::array<std::size_t, 3> chosen{};
    for (std::uint64_t k = 0; k < chosen.size(); ++k)
      chosen[k] = static_cast<std::size_t>(random.uniform(draw, k) * static_cast<double>(samples.size()));
    const auto x = [&](std::size_t k) {
      return static_cast<double>(samples[chosen[k]].cols - samples[chosen[0]].cols);
    };
    const auto y = [&](std::size_t k) {
      return static_cast<double>(samples[chosen[k]].rows - samples[chosen[0]].rows);
    };
    const double determinant = x(1) * y(2) - x(2) * y(1);
    if (determinant == 0) continue;
    triples.push_back(
        {chosen, {y(2) / determinant, -y(1) / determinant}, {-x(2) / determinant, x(1) / determinant}});
  }
  return triples;
}

}  // namespace

HWY_EXPORT(MeasureLmedsRows);

PlaceMeasures measure_lmeds(const Grid<double>& z, const LanderStencil& lander, const BinMask& places,
                            const ProgressCallback& progress) {
  const Reach reach = Reach::of_body(lander);
  const PaddedMap padded(z, reach.bins());
  const BinMask known = reach.known(padded, places);
  const std::vector<BinOffset> samples = samples_of(lander.body);
  const std::vector<SampleTriple> triples = draw_triples(samples);
  const LmedsInput input{{padded, lander.body, lander.resolution_m, known}, samples, triples};
  return measure_rows(
      z.spec(),
      [&](std::int64_t begin, std::int64_t end, PlaceMeasures& result) {
        HWY_DYNAMIC_DISPATCH(MeasureLmedsRows)(input, begin, end, result);
      },
      progress);
}

}  // namespace landfall
#endif
