// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/draw_layers.h"

#include <utility>

#include "base/numerics/non_finite.h"
#include "chain/evaluation/piecewise.h"

namespace landfall {
namespace {

Grid<float> layer_of(const GridSpec& spec, const auto& value) {
  auto layer = Grid<float>::unset(spec);
  for_each_index(spec.size(), [&](std::size_t i) { layer.values()[i] = static_cast<float>(value(i)); });
  return layer;
}

}  // namespace

std::array<FailureMap, 4> failure_maps(const DrawMaps& maps) {
  constexpr std::array<std::pair<const char*, const char*>, kCountedFlags.size()> kWords = {
      {{"p_fail_rel_x", "the relative error of x"},
       {"p_fail_rel_y", "the relative error of y"},
       {"p_fail_rel_z", "the relative error of z"},
       {"p_fail_absolute", "the absolute horizontal error"}}};
  const auto map = [&](std::size_t k) {
    return FailureMap{kWords[k].first, kWords[k].second, requirement_of(kCountedFlags[k]), maps.failing[k]};
  };
  return {map(0), map(1), map(2), map(3)};
}

Grid<float> share_of_draws(const Grid<std::int32_t>& count, std::int64_t draws, const BinMask* region) {
  const auto n = static_cast<double>(draws);
  return layer_of(count.spec(), [&](std::size_t i) {
    const bool is_outside = region != nullptr && region->values()[i] == 0;
    return is_outside || draws == 0 ? kNan : count.values()[i] / n;
  });
}

Grid<float> share_of_known(const SafetyCounts& safety, const Grid<std::int32_t>& count) {
  return layer_of(count.spec(), [&](std::size_t i) {
    const std::int32_t known = safety.known.values()[i];
    return known > 0 ? static_cast<double>(count.values()[i]) / known : kNan;
  });
}

Grid<float> mean_count(const DrawMaps& maps) {
  const auto n = static_cast<double>(maps.draws);
  return layer_of(maps.spec(),
                  [&](std::size_t i) { return static_cast<double>(maps.count.values()[i]) / n; });
}

Grid<float> mean_of(const ErrorSums& sums) {
  return layer_of(sums.count.spec(), [&](std::size_t i) { return sums.mean_m(i); });
}

Grid<float> std_of(const ErrorSums& sums) {
  return layer_of(sums.count.spec(), [&](std::size_t i) { return sums.std_m(i); });
}

Grid<float> std_over_sigma(const ErrorSums& sums, const Grid<float>& sigma_m) {
  return layer_of(sigma_m.spec(), [&](std::size_t i) {
    const double predicted_m = sigma_m.values()[i];
    return predicted_m > 0 ? sums.std_m(i) / predicted_m : kNan;
  });
}

}  // namespace landfall
