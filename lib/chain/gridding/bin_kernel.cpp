// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/bin_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/gridding/bin_kernel.cpp"
#include "base/numerics/lanes-inl.h"

#include <hwy/cache_control.h>

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

using Whole = hn::Rebind<std::int32_t, D>;
using Half = hn::CappedTag<double, 4>;

/// Number of returns processed at a time, so that intermediate values, their bins and the next bins stay in
/// the first-level cache.
constexpr std::size_t kBlock = 32;
static_assert(kBlock % kMaxLanes == 0);

/// GridSpec::bin_of in SIMD lanes, computed by the same operations.
struct LaneGrid {
  V resolution, first_row, first_col, rows, cols;

  HWY_INLINE explicit LaneGrid(const GridSpec& spec)
      : resolution(constant(spec.resolution_m)),
        first_row(constant(static_cast<double>(spec.first_row))),
        first_col(constant(static_cast<double>(spec.first_col))),
        rows(constant(static_cast<double>(spec.rows))),
        cols(constant(static_cast<double>(spec.cols))) {}

  HWY_INLINE static V nearest(V steps) { return hn::Floor(hn::Add(steps, constant(0.5))); }
  HWY_INLINE M contains(V row, V col) const {
    const V zero = hn::Zero(D());
    return hn::And(hn::And(hn::Ge(row, zero), hn::Lt(row, rows)),
                   hn::And(hn::Ge(col, zero), hn::Lt(col, cols)));
  }
};

/// 1 - |u - n|, n the integer nearest to u.
HWY_INLINE V Nearness(V u, V n) { return hn::Sub(constant(1), hn::Abs(hn::Sub(u, n))); }

HWY_INLINE V LoadAt(std::span<const double> column, std::size_t i) {
  return hn::LoadU(D(), column.data() + i);
}

/// Intermediate values of a block of returns.
struct Block {
  alignas(64) std::array<double, kBlock> weight;
  alignas(64) std::array<double, kBlock> z_first;
  alignas(64) std::array<std::int32_t, kBlock> bin;  ///< -1 outside
  alignas(64) std::array<double, 4 * kBlock> first_summands;
  alignas(64) std::array<double, 4 * kBlock> last_summands;
  std::array<BinSums*, kBlock> sums;
};

/// Computes the bins and weights of a block.
HWY_INLINE void PlaceBlock(const GridPoints& p, std::size_t begin, std::size_t count, const LaneGrid& grid,
                           BinWeights weights, Block& block) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V x = LoadAt(p.x_est, begin + i);
    const V y = LoadAt(p.y_est, begin + i);
    const V u = hn::Div(x, grid.resolution);
    const V v = hn::Div(y, grid.resolution);
    const V nearest_x = LaneGrid::nearest(u);
    const V nearest_y = LaneGrid::nearest(v);
    const V col = hn::Sub(nearest_x, grid.first_col);
    const V row = hn::Sub(nearest_y, grid.first_row);
    const V bin =
        hn::IfThenElse(grid.contains(row, col), hn::Add(hn::Mul(row, grid.cols), col), constant(-1));
    hn::Store(hn::DemoteTo(Whole(), bin), Whole(), block.bin.data() + i);
    const V weight =
        weights == BinWeights::equal ? constant(1) : hn::Mul(Nearness(u, nearest_x), Nearness(v, nearest_y));
    hn::Store(weight, D(), block.weight.data() + i);
  }
}

/// Prefetches the bins. Returns how many returns lie outside; these are sent to
/// `sink`.
HWY_INLINE std::size_t AskForBins(std::size_t count, std::span<BinSums> bins, BinSums& sink, Block& block) {
  std::size_t outside = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const bool inside = block.bin[i] >= 0;
    BinSums* const sums = inside ? &bins[static_cast<std::size_t>(block.bin[i])] : &sink;
    outside += inside ? 0 : 1;
    hwy::Prefetch(sums);
    hwy::Prefetch(&sums->z_first);
    block.sums[i] = sums;
  }
  return outside;
}

/// Counts the returns in their bins and sets the first elevation of each bin.
HWY_INLINE void CountBlock(const GridPoints& p, std::size_t begin, std::size_t count, Block& block) {
  for (std::size_t i = 0; i < count; ++i) {
    BinSums& sums = *block.sums[i];
    const double z = sums.count == 0 ? p.z_est[begin + i] : sums.z_first;
    sums.z_first = z;
    ++sums.count;
    block.z_first[i] = z;
  }
}

/// The eight summands of each return, side by side in the order of BinSums.
HWY_INLINE void MultiplyBlock(const GridPoints& p, std::size_t begin, std::size_t count, Block& block) {
  for (std::size_t i = 0; i < count; i += hn::Lanes(D())) {
    const V w = hn::Load(D(), block.weight.data() + i);
    const V dz = hn::Sub(LoadAt(p.z_est, begin + i), hn::Load(D(), block.z_first.data() + i));
    const V w_dz = hn::Mul(w, dz);
    hn::StoreInterleaved4(w, w_dz, hn::Mul(w_dz, dz), hn::Mul(w, LoadAt(p.x_true, begin + i)), D(),
                          block.first_summands.data() + 4 * i);
    hn::StoreInterleaved4(hn::Mul(w, LoadAt(p.y_true, begin + i)), hn::Mul(w, LoadAt(p.x_est, begin + i)),
                          hn::Mul(w, LoadAt(p.y_est, begin + i)), hn::Mul(w, LoadAt(p.t, begin + i)), D(),
                          block.last_summands.data() + 4 * i);
  }
}

HWY_INLINE void AddFour(const double* summands, double* sums) {
  for (std::size_t k = 0; k < 4; k += hn::Lanes(Half()))
    hn::StoreU(hn::Add(hn::LoadU(Half(), sums + k), hn::Load(Half(), summands + k)), Half(), sums + k);
}

HWY_INLINE void AddBlock(std::size_t count, const Block& block) {
  for (std::size_t i = 0; i < count; ++i) {
    AddFour(block.first_summands.data() + 4 * i, &block.sums[i]->weight);
    AddFour(block.last_summands.data() + 4 * i, &block.sums[i]->w_y_true);
  }
}

/// The columns must be readable up to a whole number of vectors. Returns how many points lie outside.
HWY_INLINE std::size_t AddReadable(const GridPoints& p, std::size_t count, const LaneGrid& grid,
                                   BinWeights weights, std::span<BinSums> bins) {
  std::size_t outside = 0;
  std::array<Block, 2> blocks;
  BinSums sink{};
  const auto prepare = [&](std::size_t begin) HWY_ATTR {
    const std::size_t size = std::min(kBlock, count - begin);
    Block& block = blocks[begin / kBlock % 2];
    PlaceBlock(p, begin, size, grid, weights, block);
    outside += AskForBins(size, bins, sink, block);
  };
  if (count > 0) prepare(0);
  for (std::size_t begin = 0; begin < count; begin += kBlock) {
    if (begin + kBlock < count) prepare(begin + kBlock);  // its bins are fetched in the meantime
    const std::size_t size = std::min(kBlock, count - begin);
    Block& block = blocks[begin / kBlock % 2];
    CountBlock(p, begin, size, block);
    MultiplyBlock(p, begin, size, block);
    AddBlock(size, block);
  }
  return outside;
}

std::size_t AddReturns(const GridPoints& points, const GridSpec& spec, BinWeights weights,
                       std::span<BinSums> bins) {
  const LaneGrid grid(spec);
  const std::size_t whole = points.size() / hn::Lanes(D()) * hn::Lanes(D());
  const std::size_t outside = AddReadable(points, whole, grid, weights, bins);
  const GridPoints rest = points.subset(whole, points.size() - whole);
  if (rest.size() == 0) return outside;
  std::array<std::array<double, kMaxLanes>, 7> padded{};
  GridPoints::Columns columns = rest.columns();
  for (std::size_t c = 0; c < columns.size(); ++c) {
    std::ranges::copy(columns[c], padded[c].begin());
    columns[c] = padded[c];
  }
  return outside + AddReadable(GridPoints::of(columns), rest.size(), grid, weights, bins);
}

using TileNumbers = hn::Rebind<std::uint32_t, D>;
using Part = hn::Rebind<std::uint8_t, D>;
using Bytes = hn::CappedTag<std::uint8_t, kPointsPerWord>;

/// Finds the parts of kPointsPerWord points. Tile numbers are multiplied by the fractions of the
/// two-dimensional sequence R2, times 2^32, which spreads the parts of neighbouring tiles evenly along rows
/// and columns.
HWY_INLINE void FindPartsOfWord(const double* x, const double* y, const LaneGrid& grid, const Tiling& tiling,
                                std::uint8_t* parts) {
  const auto across = hn::Set(TileNumbers(), 3242174889U);
  const auto up = hn::Set(TileNumbers(), 2447445414U);
  for (std::size_t i = 0; i < kPointsPerWord; i += hn::Lanes(D())) {
    const V u = hn::Div(hn::LoadU(D(), x + i), grid.resolution);
    const V v = hn::Div(hn::LoadU(D(), y + i), grid.resolution);
    const auto col = hn::DemoteTo(Whole(), hn::Sub(LaneGrid::nearest(u), grid.first_col));
    const auto row = hn::DemoteTo(Whole(), hn::Sub(LaneGrid::nearest(v), grid.first_row));
    const auto tile_col = hn::ShiftRightSame(hn::BitCast(TileNumbers(), col), tiling.tile_bits);
    const auto tile_row = hn::ShiftRightSame(hn::BitCast(TileNumbers(), row), tiling.tile_bits);
    const auto mixed = hn::Add(hn::Mul(tile_col, across), hn::Mul(tile_row, up));
    // Two shifts, since a shift by all 32 bits is undefined.
    const auto part = hn::ShiftRightSame(hn::ShiftRight<1>(mixed), 31 - tiling.part_bits);
    hn::StoreU(hn::TruncateTo(Part(), part), Part(), parts + i);
  }
}

HWY_INLINE std::uint64_t BitsOfPart(const std::uint8_t* parts, std::uint8_t part) {
  static_assert(std::endian::native == std::endian::little);  // required by the byte order of `some`
  std::uint64_t bits = 0;
  const auto wanted = hn::Set(Bytes(), part);
  for (std::size_t i = 0; i < kPointsPerWord; i += hn::Lanes(Bytes())) {
    std::uint64_t some = 0;
    hn::StoreMaskBits(Bytes(), hn::Eq(hn::LoadU(Bytes(), parts + i), wanted),
                      reinterpret_cast<std::uint8_t*>(&some));
    bits |= some << i;
  }
  return bits;
}

void FindParts(const GridSpec& spec, const Tiling& tiling, std::span<const double> x_m,
               std::span<const double> y_m, std::size_t stride, std::uint64_t* bits) {
  const LaneGrid grid(spec);
  const std::size_t part_count = std::size_t{1} << static_cast<unsigned>(tiling.part_bits);
  alignas(64) std::array<std::uint8_t, kPointsPerWord> parts;
  std::array<double, kPointsPerWord> last_x{};
  std::array<double, kPointsPerWord> last_y{};
  for (std::size_t begin = 0; begin < x_m.size(); begin += kPointsPerWord) {
    const std::size_t rest = x_m.size() - begin;
    const bool is_whole = rest >= kPointsPerWord;
    if (!is_whole) {
      std::ranges::copy(x_m.subspan(begin), last_x.begin());
      std::ranges::copy(y_m.subspan(begin), last_y.begin());
    }
    FindPartsOfWord(is_whole ? &x_m[begin] : last_x.data(), is_whole ? &y_m[begin] : last_y.data(), grid,
                    tiling, parts.data());
    const std::uint64_t points = is_whole ? ~std::uint64_t{0} : (std::uint64_t{1} << rest) - 1;
    for (std::size_t part = 0; part < part_count; ++part)
      bits[part * stride + begin / kPointsPerWord] =
          points & BitsOfPart(parts.data(), static_cast<std::uint8_t>(part));
  }
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(AddReturns);
HWY_EXPORT(FindParts);

std::size_t add_returns(const GridPoints& points, const GridSpec& spec, BinWeights weights,
                        std::span<BinSums> bins) {
  assert(bins.size() == spec.size());
  return HWY_DYNAMIC_DISPATCH(AddReturns)(points, spec, weights, bins);
}

void find_parts(const GridSpec& spec, const Tiling& tiling, std::span<const double> x_m,
                std::span<const double> y_m, std::size_t stride, std::uint64_t* bits) {
  assert(x_m.size() == y_m.size());
  HWY_DYNAMIC_DISPATCH(FindParts)(spec, tiling, x_m, y_m, stride, bits);
}

}  // namespace landfall
#endif
