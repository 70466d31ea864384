// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/large_memory.h"
#include "raster/grid_spec.h"

namespace landfall {

/// One value per bin, row-major, y ascending.
template <class T>
class Grid {
 public:
  Grid() = default;
  explicit Grid(const GridSpec& spec, T fill = T{}) : spec_(spec), values_(spec.size(), fill) {}
  /// A grid whose values are not initialised: write all of them before reading any.
  [[nodiscard]] static Grid unset(const GridSpec& spec) {
    Grid grid;
    grid.spec_ = spec;
    grid.values_.resize(spec.size());
    return grid;
  }

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  /// The bin must lie in the grid.
  [[nodiscard]] const T& at(BinIndex bin) const { return values_[spec_.index(bin)]; }
  [[nodiscard]] T& at(BinIndex bin) { return values_[spec_.index(bin)]; }
  [[nodiscard]] std::span<const T> values() const { return values_; }
  [[nodiscard]] std::span<T> values() { return values_; }
  [[nodiscard]] std::span<const T> row(std::int64_t row) const {
    return values().subspan(static_cast<std::size_t>(row * spec_.cols), static_cast<std::size_t>(spec_.cols));
  }
  [[nodiscard]] std::span<T> row(std::int64_t row) {
    return values().subspan(static_cast<std::size_t>(row * spec_.cols), static_cast<std::size_t>(spec_.cols));
  }

 private:
  GridSpec spec_;
  std::vector<T, LargeAllocator<T>> values_;
};

}  // namespace landfall
