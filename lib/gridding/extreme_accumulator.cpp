// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D50
#include "gridding/extreme_accumulator.h"

#include <algorithm>
#include <cmath>

namespace landfall {

ExtremeAccumulator::ExtremeAccumulator(const GridSpec& spec, Which which)
    : Accumulator(spec), which_(which), bins_(this->spec().size()), nearest_(spec) {}

void ExtremeAccumulator::add(const GridPoints& points) {
  const std::span<Bin> bins = bins_.values();
  const std::size_t outside =
      nearest_.for_each(points, [&](const GridSpec&, const GridPoints& piece, std::size_t i,
                                    std::size_t bin) { add_point(piece, i, bins[bin]); });
  count_points(points.size(), outside);
}

void ExtremeAccumulator::add_point(const GridPoints& points, std::size_t i, Bin& bin) const {
  const double z = points.z_est[i];
  if (bin.count == 0) bin.z_first = z;
  if (bin.count == 0 || (which_ == Which::lowest ? z < bin.chosen.z : z > bin.chosen.z))
    bin.chosen = {.z = z,
                  .x_true = points.x_true[i],
                  .y_true = points.y_true[i],
                  .x_est = points.x_est[i],
                  .y_est = points.y_est[i],
                  .t = points.t[i]};
  const double dz = z - bin.z_first;
  bin.dz += dz;
  bin.dz_dz += dz * dz;
  ++bin.count;
}

BinValues ExtremeAccumulator::values_of(const Bin& bin) {
  if (bin.count == 0) return empty_bin();
  const auto n = static_cast<double>(bin.count);
  const double mean_dz = bin.dz / n;
  return landfall::values_of(bin.chosen, bin.count,
                             std::sqrt(std::max(0.0, bin.dz_dz / n - mean_dz * mean_dz)));
}

void ExtremeAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const Bin> bins = bins_.values().subspan(spec().index(first), out.size());
  std::ranges::transform(bins, out.begin(), values_of);
}

}  // namespace landfall
