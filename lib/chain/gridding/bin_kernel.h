// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "base/raster/grid_spec.h"
#include "chain/gridding/bin_sums.h"
#include "chain/gridding/grid_points.h"

namespace landfall {

enum class BinWeights { bilinear, equal };

/// Adds the returns, in their order, to the bins in which they lie (row-major, those of `spec`, at most 2^31
/// - 1). Gives the same bits as add_return() with the weight of WeightedMeanAccumulator. Returns how many lie
/// in no bin. Uses SIMD lanes by run-time dispatch. The grid's first row and column lie within +-2^52.
std::size_t add_returns(const GridPoints& points, const GridSpec& spec, BinWeights weights,
                        std::span<BinSums> bins);

/// How bins are divided among 2^part_bits parts: by tiles of 2^tile_bits x 2^tile_bits bins.
struct Tiling {
  int tile_bits;
  int part_bits;  ///< at most 6
};
inline constexpr std::size_t kPointsPerWord = 64;

/// Point i belongs to part p where bit i % 64 of bits[p * stride + i / 64] is set: each point to exactly one
/// part, all points of a bin to the same part. x and y have the same length; bits after the last point are 0.
void find_parts(const GridSpec& spec, const Tiling& tiling, std::span<const double> x_m,
                std::span<const double> y_m, std::size_t stride, std::uint64_t* bits);

}  // namespace landfall
