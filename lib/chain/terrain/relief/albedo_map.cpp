// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D338, D339
#include "chain/terrain/relief/albedo_map.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/core/parallel.h"

namespace landfall {
namespace {

std::int64_t tiles_along(std::int64_t nodes, std::int64_t tile) { return (nodes + tile - 1) / tile; }

}  // namespace

AlbedoMap::AlbedoMap(const GridSpec& spec, const BinIndex& tile, Load load)
    : spec_(spec),
      tile_(tile),
      tiles_per_row_(tiles_along(spec.cols, tile.col)),
      load_(std::move(load)),
      tiles_(static_cast<std::size_t>(tiles_along(spec.rows, tile.row) * tiles_per_row_)) {}

const Grid<float>& AlbedoMap::tile(const BinIndex& number) const {
  std::atomic<const Grid<float>*>& entry =
      tiles_[static_cast<std::size_t>(number.row * tiles_per_row_ + number.col)];
  if (const Grid<float>* const known = entry.load(std::memory_order_acquire)) return *known;
  const std::lock_guard lock(loading_);
  if (const Grid<float>* const known = entry.load(std::memory_order_acquire)) return *known;
  const std::int64_t row = number.row * tile_.row;
  const std::int64_t col = number.col * tile_.col;
  const GridSpec window{spec_.resolution_m, spec_.first_row + row, spec_.first_col + col,
                        std::min(tile_.row, spec_.rows - row), std::min(tile_.col, spec_.cols - col)};
  run_isolated([&] { loaded_.push_back(load_(window)); });
  entry.store(&loaded_.back(), std::memory_order_release);
  return loaded_.back();
}

double AlbedoMap::at(double x_m, double y_m) const {
  const BinIndex node = spec_.bin_of(x_m, y_m);
  if (!spec_.contains(node)) return std::numeric_limits<double>::quiet_NaN();
  const Grid<float>& values = tile({node.row / tile_.row, node.col / tile_.col});
  return static_cast<double>(values.at({node.row % tile_.row, node.col % tile_.col}));
}

}  // namespace landfall
