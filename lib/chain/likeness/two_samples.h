// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace landfall {

/// A scan's returns, in the order of their times, are cut into as many blocks of equally many returns.
inline constexpr std::size_t kLikenessBlocks = 40;

/// One block of one of two scans: 2 block + scan (0: A, 1: B).
using BlockOfScan = std::uint8_t;
inline constexpr std::size_t kBlocksOfScans = 2 * kLikenessBlocks;

/// The block of return `i` of `count` (in the order of times) of scan 0 or 1.
[[nodiscard]] BlockOfScan block_of(std::size_t i, std::size_t count, std::size_t scan);

/// The side, 0 or 1, that each block counts to.
using Sides = std::array<std::uint8_t, kBlocksOfScans>;

/// Each block on the side of its scan.
[[nodiscard]] Sides original_sides();
/// The blocks k of both scans change sides with probability 1/2, for each k independently. If both scans are
/// draws of one process, any statistic has the same distribution with these sides as with the original ones,
/// also where the returns of a block depend on each other. A function of `number` alone.
[[nodiscard]] Sides exchanged_sides(std::uint64_t number);

/// At most `max_count` of the numbers 0 .. count - 1, ascending: all, or a random one of each of so many
/// equal strata. The random numbers do not depend on `count`, so that equal scans give equal samples.
[[nodiscard]] std::vector<std::size_t> sample_of(std::size_t count, std::size_t max_count);

struct BlockValue {
  double value = 0;
  BlockOfScan block = 0;
};

/// The values of two samples, sorted once.
class TwoSamples {
 public:
  /// NaN are left out.
  explicit TwoSamples(std::vector<BlockValue> values);

  /// The distance of Kolmogorov and Smirnov, sup |F_0 - F_1| of the empirical distributions of both sides.
  /// NaN if a side has no value. O(values).
  [[nodiscard]] double ks_distance(const Sides& sides) const;

 private:
  std::vector<BlockValue> values_;
  std::array<std::int64_t, kBlocksOfScans> counts_{};
};

/// The positions of two samples.
class TwoClouds {
 public:
  struct Position {
    double x = 0, y = 0, z = 0;
    BlockOfScan block = 0;
  };
  /// O(positions^2), in parallel.
  explicit TwoClouds(const std::vector<Position>& positions);

  /// The energy distance of Szekely and Rizzo (2013), sqrt(2 E|X - Y| - E|X - X'| - E|Y - Y'|) over all
  /// pairs, each position also with itself, in the unit of the positions' square root: m^(1/2) of metres.
  /// Exactly 0 for equal samples. NaN if a side has no position. O(blocks^2).
  [[nodiscard]] double energy_distance(const Sides& sides) const;

 private:
  std::array<std::array<double, kBlocksOfScans>, kBlocksOfScans> distances_{};  ///< summed
  std::array<double, kBlocksOfScans> counts_{};
};

}  // namespace landfall
