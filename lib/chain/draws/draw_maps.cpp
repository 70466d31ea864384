// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D313, D314
#include "chain/draws/draw_maps.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"
#include "chain/evaluation/piecewise.h"
#include "chain/hazards/safety.h"

namespace landfall {
namespace {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

constexpr double kUnitsPerMetre = 0x1p30;
/// So that n sum e^2 fits for 2^17 draws.
constexpr double kLargest_m = 0x1p16;

Int128 wide(const WideSum& sum) {
  return static_cast<Int128>((static_cast<UInt128>(static_cast<std::uint64_t>(sum.high)) << 64U) | sum.low);
}

WideSum narrow(Int128 value) {
  return {static_cast<std::uint64_t>(value), static_cast<std::int64_t>(value >> 64)};
}

}  // namespace

void ErrorSums::add(std::size_t bin, double error_m) {
  if (std::isnan(error_m)) return;
  if (!(std::abs(error_m) <= kLargest_m))
    throw FormatError("bin " + std::to_string(bin) + ": the error of " + std::to_string(error_m) +
                      " m is beyond +-65,536 m");
  const auto units = static_cast<std::int64_t>(std::nearbyint(error_m * kUnitsPerMetre));
  ++count.values()[bin];
  sum.values()[bin] += units;
  squares.values()[bin] = narrow(wide(squares.values()[bin]) + static_cast<Int128>(units) * units);
}

void ErrorSums::merge(const ErrorSums& other) {
  for_each_index(count.values().size(), [&](std::size_t i) {
    count.values()[i] += other.count.values()[i];
    sum.values()[i] += other.sum.values()[i];
    squares.values()[i] = narrow(wide(squares.values()[i]) + wide(other.squares.values()[i]));
  });
}

double ErrorSums::mean_m(std::size_t bin) const {
  const std::int32_t n = count.values()[bin];
  return n == 0 ? kNan : static_cast<double>(sum.values()[bin]) / n / kUnitsPerMetre;
}

double ErrorSums::std_m(std::size_t bin) const {
  const std::int32_t n = count.values()[bin];
  if (n < 2) return kNan;
  const Int128 total = sum.values()[bin];
  const Int128 spread = n * wide(squares.values()[bin]) - total * total;
  const auto draws = static_cast<double>(n);
  return std::sqrt(static_cast<double>(spread) / draws / (draws - 1)) / kUnitsPerMetre;
}

void SafetyCounts::add(const Grid<std::int8_t>& outcome) {
  for_each_index(outcome.values().size(), [&](std::size_t i) {
    const auto value = static_cast<HazardOutcome>(outcome.values()[i]);
    if (value == HazardOutcome::unknown) return;
    ++known.values()[i];
    if (value == HazardOutcome::safe_found || value == HazardOutcome::missed_hazard)
      ++judged_safe.values()[i];
    if (value == HazardOutcome::missed_hazard) ++missed.values()[i];
  });
}

void SafetyCounts::merge(const SafetyCounts& other) {
  for (const auto member : {&SafetyCounts::known, &SafetyCounts::judged_safe, &SafetyCounts::missed})
    for_each_index(known.values().size(),
                   [&](std::size_t i) { (this->*member).values()[i] += (other.*member).values()[i]; });
}

DrawMaps::DrawMaps(const GridSpec& grid)
    : invalid(grid),
      failing{Grid<std::int32_t>(grid), Grid<std::int32_t>(grid), Grid<std::int32_t>(grid),
              Grid<std::int32_t>(grid)},
      count(grid),
      e_z(grid),
      e_map(std::in_place, grid) {}

void DrawMaps::add(const DrawnLayers& draw, const Grid<double>* map_truth) {
  add_dem(draw.dem, map_truth);
  add_verdicts(draw.fail);
  if (draw.outcome) safety->add(*draw.outcome);
}

void DrawMaps::add_dem(const DrawnDem& dem, const Grid<double>* map_truth) {
  const auto z_est = dem.layers.z_est.values();
  const auto z_true = dem.layers.truth->z.values();
  for_each_index(z_est.size(), [&](std::size_t i) {
    count.values()[i] += dem.count.values()[i];
    if (std::isnan(z_est[i])) {
      ++invalid.values()[i];
      return;
    }
    e_z.add(i, z_true[i] - z_est[i]);
    if (e_map) e_map->add(i, map_truth->values()[i] - z_est[i]);
  });
  ++draws;
}

void DrawMaps::add_verdicts(const Grid<std::int8_t>& fail) {
  for_each_index(fail.values().size(), [&](std::size_t i) {
    const int flags = fail.values()[i];
    if (flags == 0) return;
    for (std::size_t k = 0; k < failing.size(); ++k)
      failing[k].values()[i] += (flags & kCountedFlags[k]) != 0 ? 1 : 0;
  });
}

void DrawMaps::merge(const DrawMaps& other) {
  draws += other.draws;
  for_each_index(spec().size(), [&](std::size_t i) {
    invalid.values()[i] += other.invalid.values()[i];
    for (std::size_t k = 0; k < failing.size(); ++k) failing[k].values()[i] += other.failing[k].values()[i];
    count.values()[i] += other.count.values()[i];
  });
  e_z.merge(other.e_z);
  if (e_map) e_map->merge(*other.e_map);
  if (safety) safety->merge(*other.safety);
}

}  // namespace landfall
