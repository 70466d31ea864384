// SPDX-License-Identifier: GPL-3.0-or-later
// Threads share the bins of weighted sums by tiles of 32 to several hundred bins a side, independent of
// the scan direction: bands of rows leave threads idle if lines run along them. No bin is shared between
// threads, so that sums depend neither on the number of threads nor on the tiles.
#include "chain/gridding/tile_partition.h"

#include <algorithm>
#include <bit>
#include <cassert>

#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr int kMaxPartBits = 6;
constexpr std::size_t kPointsPerTilePiece = std::size_t{1} << 14U;
static_assert(kPointsPerTilePiece % kPointsPerWord == 0);

/// The number of tiles for each part along a row of the grid, unless tiles become too small: more tiles
/// balance the work of the parts, but spread the points of a scanner's image over more of them.
constexpr std::uint64_t kTilesPerPart = 1;
constexpr int kMinTileBits = 5;

int bits_of(std::uint64_t number) { return static_cast<int>(std::bit_width(number)) - 1; }

Tiling tiling_of(const GridSpec& spec, std::size_t min_parts) {
  const int part_bits = std::min(kMaxPartBits, bits_of(std::bit_ceil(min_parts)));
  const auto tile = static_cast<std::uint64_t>(spec.cols) / (kTilesPerPart << part_bits);
  return {.tile_bits = std::max(kMinTileBits, bits_of(tile)), .part_bits = part_bits};
}

}  // namespace

TilePartition::TilePartition(const GridSpec& spec, std::size_t min_parts)
    : spec_(spec), tiling_(tiling_of(spec, min_parts)) {}

void TilePartition::assign(std::span<const double> x_m, std::span<const double> y_m) {
  assert(x_m.size() == y_m.size());
  words_ = (x_m.size() + kPointsPerWord - 1) / kPointsPerWord;
  bits_.resize(words_ * part_count());
  parallel_for(x_m.size(), kPointsPerTilePiece, [&](std::size_t begin, std::size_t end) {
    find_parts(spec_, tiling_, x_m.subspan(begin, end - begin), y_m.subspan(begin, end - begin), words_,
               &bits_[begin / kPointsPerWord]);
  });
}

}  // namespace landfall
