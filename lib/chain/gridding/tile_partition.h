// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/raster/grid_spec.h"
#include "chain/gridding/bin_kernel.h"

namespace landfall {

/// Distributes points by square tiles of the grid, so that parts can be summed in parallel while each bin
/// still sees its points in the order of arrival. Tiles are assigned to parts pseudo-randomly: a scan line in
/// any direction crosses all parts, and many consecutive points belong to one part.
class TilePartition {
 public:
  /// Creates at least `min_parts` parts, at most 64. The grid's rows and columns lie below
  /// 2^31.
  TilePartition(const GridSpec& spec, std::size_t min_parts);

  [[nodiscard]] std::size_t part_count() const { return std::size_t{1} << tiling_.part_bits; }
  /// The edge of a tile in bins.
  [[nodiscard]] std::int64_t tile_side() const { return std::int64_t{1} << tiling_.tile_bits; }

  /// Sorts points again; x and y, metres, have one length. A bit per point and part, kept for the next batch.
  void assign(std::span<const double> x_m, std::span<const double> y_m);

  /// Point i belongs to the part where bit i % 64 of word i / 64 is set: each point to exactly one part, all
  /// points of a tile to the same part, points in no bin to any part.
  [[nodiscard]] std::span<const std::uint64_t> points_of_part(std::size_t part) const {
    return std::span(bits_).subspan(part * words_, words_);
  }

 private:
  GridSpec spec_;
  Tiling tiling_;
  std::size_t words_ = 0;
  std::vector<std::uint64_t> bits_;
};

}  // namespace landfall
