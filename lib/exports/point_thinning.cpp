// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/point_thinning.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace landfall {
namespace {

/// Of more candidates only the cubes whose mixed number is a multiple of kSampled are counted.
constexpr std::size_t kFewCandidates = 65536;
constexpr std::uint64_t kSampled = 16;

constexpr std::uint64_t kWhole = std::uint64_t{1} << 32U;  ///< a cube that holds all places

/// Numbers of neighbouring cubes share no bits of this.
std::uint64_t mixed(std::uint64_t number) {
  number = (number ^ (number >> 31U)) * 0x9e3779b97f4a7c15U;
  return number ^ (number >> 29U);
}

}  // namespace

PointThinning::PointThinning(const PointPlace& low, const PointPlace& high, double cell_m, std::size_t most)
    : low_(low), most_(most) {
  double extent_m = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) extent_m = std::max(extent_m, high[axis] - low[axis]);
  unit_m_ = extent_m > 0 ? extent_m / (std::ldexp(1.0, kFineBits) - 1) : 1;
  const double edge =
      std::clamp(cell_m / unit_m_, std::ldexp(1.0, kFineBits - kBits), std::ldexp(1.0, kFineBits));
  edge_ = static_cast<std::uint64_t>(edge);
}

void PointThinning::add(const PointPlace& place, std::uint64_t row) {
  Candidate candidate{{}, row};
  for (std::size_t axis = 0; axis < 3; ++axis)
    candidate.place[axis] = static_cast<std::uint32_t>((place[axis] - low_[axis]) / unit_m_);
  candidates_.push_back(candidate);
  ++added_;
  if (candidates_.size() < 2 * kSpare * most_) return;
  while (true) {
    candidates_ = one_per_cell(candidates_, edge_);
    is_thinned_ = is_thinned_ || candidates_.size() < added_;
    if (candidates_.size() <= kSpare * most_) return;
    edge_ *= 2;
  }
}

PointThinning::Cell PointThinning::cell_of(const Candidate& candidate, std::uint64_t edge) {
  Cell cell{0, 0};
  for (const std::uint32_t place : candidate.place) {
    const std::uint64_t number = place / edge;
    const double from_middle = static_cast<double>(place - number * edge) - 0.5 * static_cast<double>(edge);
    cell.number = (cell.number << static_cast<unsigned>(kBits)) | number;
    cell.distance += from_middle * from_middle;
  }
  return cell;
}

std::vector<PointThinning::Candidate> PointThinning::one_per_cell(const std::vector<Candidate>& candidates,
                                                                  std::uint64_t edge) {
  struct Ranked {
    Cell cell;
    std::uint32_t index;
  };
  std::vector<Ranked> ranked(candidates.size());
  parallel_for(ranked.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      ranked[i] = {cell_of(candidates[i], edge), static_cast<std::uint32_t>(i)};
  });
  std::ranges::sort(ranked, [](const Ranked& a, const Ranked& b) {
    if (a.cell.number != b.cell.number) return a.cell.number < b.cell.number;
    return a.cell.distance != b.cell.distance ? a.cell.distance < b.cell.distance : a.index < b.index;
  });
  const auto same = [](const Ranked& a, const Ranked& b) { return a.cell.number == b.cell.number; };
  ranked.erase(std::unique(ranked.begin(), ranked.end(), same), ranked.end());
  std::ranges::sort(ranked, {}, &Ranked::index);
  std::vector<Candidate> kept;
  kept.reserve(ranked.size());
  for (const Ranked& r : ranked) kept.push_back(candidates[r.index]);
  return kept;
}

std::size_t PointThinning::cells(std::uint64_t edge) const {
  const std::uint64_t sampled = candidates_.size() > kFewCandidates ? kSampled : 1;
  std::vector<std::uint64_t> numbers;
  for (const Candidate& candidate : candidates_) {
    const std::uint64_t number = cell_of(candidate, edge).number;
    if (mixed(number) % sampled == 0) numbers.push_back(number);
  }
  std::ranges::sort(numbers);
  return sampled * static_cast<std::size_t>(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

/// The smallest edge, within 2 %, of which no more cubes than `most_` hold a candidate.
std::uint64_t PointThinning::last_edge() const {
  const auto scaled = [](std::uint64_t edge, double factor) {
    return static_cast<std::uint64_t>(static_cast<double>(edge) * factor) + 1;
  };
  std::uint64_t low = edge_;
  std::uint64_t high = edge_;
  while (high < kWhole && cells(high) > most_) {
    low = high;
    high *= 2;
  }
  while (scaled(low, 1.02) < high) {
    const std::uint64_t middle = scaled(low, std::sqrt(static_cast<double>(high) / static_cast<double>(low)));
    (cells(middle) > most_ ? low : high) = middle;
  }
  return high;
}

ThinnedPoints PointThinning::finish() {
  if (is_thinned_ || candidates_.size() > most_) {
    is_thinned_ = true;
    edge_ = last_edge();
    candidates_ = one_per_cell(candidates_, edge_);
    while (candidates_.size() > most_) {  // because cells() is not exact
      edge_ += edge_ / 64;
      candidates_ = one_per_cell(candidates_, edge_);
    }
  }
  ThinnedPoints result;
  result.cell_m = is_thinned_ ? unit_m_ * static_cast<double>(edge_) : 0;
  for (const Candidate& candidate : candidates_) result.rows.push_back(candidate.row);
  return result;
}

}  // namespace landfall
