// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/hole_filling.h"

#include <cmath>
#include <cstdlib>
#include <limits>

#include "base/raster/holes.h"
#include "base/raster/region.h"

namespace landfall {
namespace {

/// Calls each(value) for the ring's bins in the map.
template <class Each>
void for_ring(const Grid<double>& layer, BinIndex centre, std::int64_t ring, const Each& each) {
  for (std::int64_t row = -ring; row <= ring; ++row) {
    const std::int64_t step = std::abs(row) == ring ? 1 : 2 * ring;
    for (std::int64_t col = -ring; col <= ring; col += step) {
      const BinIndex bin{centre.row + row, centre.col + col};
      if (layer.spec().contains(bin)) each(layer.at(bin));
    }
  }
}

std::int64_t nearest_ring(const Grid<double>& map, BinIndex bin) {
  for (std::int64_t ring = 1;; ++ring) {
    bool has_value = false;
    for_ring(map, bin, ring, [&](double z) { has_value = has_value || std::isfinite(z); });
    if (has_value) return ring;
  }
}

}  // namespace

std::vector<FillableBin> small_holes(const Grid<double>& map, std::int64_t max_bins) {
  const GridSpec& spec = map.spec();
  BinMask missing(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) missing.values()[i] = std::isfinite(map.values()[i]) ? 0 : 1;
  const HoleLabels labels = label_holes(missing);
  const auto is_small = [&](const Hole& hole) {
    const bool touches_border = hole.south_west.row == 0 || hole.south_west.col == 0 ||
                                hole.north_east.row == spec.rows - 1 || hole.north_east.col == spec.cols - 1;
    return hole.size_bins <= max_bins && !touches_border;
  };
  std::vector<FillableBin> found;
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex bin{row, col};
      const std::int32_t id = labels.id.at(bin);
      if (id > 0 && is_small(labels.holes[static_cast<std::size_t>(id - 1)]))
        found.push_back({bin, nearest_ring(map, bin)});
    }
  return found;
}

double ring_mean(const Grid<double>& layer, const FillableBin& hole) {
  double sum = 0;
  std::int64_t count = 0;
  for_ring(layer, hole.bin, hole.ring, [&](double value) {
    if (!std::isfinite(value)) return;
    sum += value;
    ++count;
  });
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / static_cast<double>(count);
}

void fill_holes(Grid<double>& layer, const std::vector<FillableBin>& holes) {
  std::vector<double> means;
  means.reserve(holes.size());
  for (const FillableBin& hole : holes) means.push_back(ring_mean(layer, hole));
  for (std::size_t i = 0; i < holes.size(); ++i) layer.at(holes[i].bin) = means[i];
}

}  // namespace landfall
