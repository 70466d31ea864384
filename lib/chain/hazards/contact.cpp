// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "chain/hazards/lane_input.h"
#include "chain/hazards/measure_rows.h"
#include "chain/hazards/reach.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/hazards/contact.cpp"
#include "base/numerics/lanes-inl.h"
#include "base/raster/by_rows.h"
#include "chain/hazards/contact_planes-inl.h"
#include "chain/hazards/contact_roughness-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Measures one row of places, group by group.
class ContactLanes {
 public:
  explicit ContactLanes(const ContactInput& input)
      : in_(input), planes_(input), roughness_(input, planes_.planes()) {}

  void MeasureRow(std::int64_t row, PlaceMeasures& result) {
    const auto wanted = in_.places.row(row);
    for (std::size_t col = 0; col < wanted.size(); col += kContactPlaces) {
      const std::size_t end = std::min(col + kContactPlaces, wanted.size());
      const auto begin_of = wanted.begin() + static_cast<std::ptrdiff_t>(col);
      const auto first = std::find(begin_of, wanted.begin() + static_cast<std::ptrdiff_t>(end), 1);
      const auto at = static_cast<std::size_t>(first - wanted.begin());
      if (at == end) continue;
      const AtPlaces<double> slope = planes_.Find(row, static_cast<std::int64_t>(col));
      AtPlaces<std::int8_t> is_wanted{};
      std::copy(begin_of, wanted.begin() + static_cast<std::ptrdiff_t>(end), is_wanted.begin());
      const AtPlaces<double> roughness =
          roughness_.Largest(row, static_cast<std::int64_t>(col), at - col, is_wanted);
      for (std::size_t c = col; c < end; ++c)
        if (wanted[c] != 0) {
          result.slope_deg.row(row)[c] = slope_deg(std::sqrt(slope[c - col]) / in_.lander.resolution_m);
          result.roughness_m.row(row)[c] = roughness[c - col];
        }
    }
  }

 private:
  const ContactInput& in_;
  ContactPlanes planes_;
  ContactRoughness roughness_;  ///< of planes_
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
  by_rows(spec, [&](std::int64_t row) {
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
