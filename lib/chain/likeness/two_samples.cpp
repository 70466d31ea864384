// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D453
#include "chain/likeness/two_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/core/parallel.h"
#include "base/numerics/random.h"

namespace landfall {
namespace {

constexpr double kNoDistance = std::numeric_limits<double>::quiet_NaN();

/// Streams of random numbers of this module: of exchanges and of samples.
const RandomField& likeness_draws() {
  static const RandomField draws(RandomSeed{}, RandomStream::likeness);
  return draws;
}

/// Sums per block, summed per side.
template <class Sums>
std::array<typename Sums::value_type, 2> of_sides(const Sums& sums, const Sides& sides) {
  std::array<typename Sums::value_type, 2> both{};
  for (std::size_t b = 0; b < kBlocksOfScans; ++b) both.at(sides[b]) += sums[b];
  return both;
}

}  // namespace

BlockOfScan block_of(std::size_t i, std::size_t count, std::size_t scan) {
  return static_cast<BlockOfScan>(2 * (i * kLikenessBlocks / count) + scan);
}

Sides original_sides() {
  Sides sides{};
  for (std::size_t b = 0; b < kBlocksOfScans; ++b) sides.at(b) = b % 2;
  return sides;
}

Sides exchanged_sides(std::uint64_t number) {
  Sides sides = original_sides();
  for (std::size_t k = 0; k < kLikenessBlocks; ++k)
    if (likeness_draws().uniform(number + 1, k) < 0.5) std::swap(sides.at(2 * k), sides.at(2 * k + 1));
  return sides;
}

std::vector<std::size_t> sample_of(std::size_t count, std::size_t max_count) {
  std::vector<std::size_t> sample(std::min(count, max_count));
  for (std::size_t k = 0; k < sample.size(); ++k) {
    const double within = count <= max_count ? 0 : likeness_draws().uniform(0, k);
    const double stratum = static_cast<double>(count) / static_cast<double>(sample.size());
    sample[k] = std::min(count - 1, static_cast<std::size_t>((static_cast<double>(k) + within) * stratum));
  }
  return sample;
}

TwoSamples::TwoSamples(std::vector<BlockValue> values) : values_(std::move(values)) {
  std::erase_if(values_, [](const BlockValue& each) { return std::isnan(each.value); });
  std::ranges::sort(values_, {}, &BlockValue::value);
  for (const BlockValue& each : values_) ++counts_.at(each.block);
}

double TwoSamples::ks_distance(const Sides& sides) const {
  const auto total = of_sides(counts_, sides);
  if (total[0] == 0 || total[1] == 0) return kNoDistance;
  std::array<std::int64_t, 2> below{};
  double largest = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    ++below.at(sides.at(values_[i].block));
    if (i + 1 < values_.size() && values_[i + 1].value == values_[i].value) continue;
    const double difference = static_cast<double>(below[0]) / static_cast<double>(total[0]) -
                              static_cast<double>(below[1]) / static_cast<double>(total[1]);
    largest = std::max(largest, std::abs(difference));
  }
  return largest;
}

TwoClouds::TwoClouds(const std::vector<Position>& positions) {
  for (const Position& each : positions) ++counts_.at(each.block);
  std::array<std::vector<Position>, kBlocksOfScans> by_block;
  for (const Position& each : positions) by_block.at(each.block).push_back(each);
  parallel_for(kBlocksOfScans, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t u = begin; u < end; ++u)
      for (std::size_t v = 0; v < kBlocksOfScans; ++v)
        for (const Position& p : by_block.at(u))
          for (const Position& q : by_block.at(v)) {
            const double x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
            distances_.at(u).at(v) += std::sqrt(x * x + y * y + z * z);
          }
  });
}

double TwoClouds::energy_distance(const Sides& sides) const {
  const auto count = of_sides(counts_, sides);
  if (count[0] == 0 || count[1] == 0) return kNoDistance;
  std::array<std::array<double, 2>, 2> sum{};
  for (std::size_t u = 0; u < kBlocksOfScans; ++u)
    for (std::size_t v = 0; v < kBlocksOfScans; ++v)
      sum.at(sides.at(u)).at(sides.at(v)) += distances_.at(u).at(v);
  const auto mean = [&](std::size_t s, std::size_t t) {
    return sum.at(s).at(t) / (count.at(s) * count.at(t));
  };
  return std::sqrt(std::max(0.0, (mean(0, 1) - mean(0, 0)) + (mean(1, 0) - mean(1, 1))));
}

}  // namespace landfall
