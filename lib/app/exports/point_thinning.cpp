// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D418
#include "app/exports/point_thinning.h"

#include <algorithm>
#include <cmath>

#include "base/core/mapped.h"
#include "base/core/parallel.h"

namespace landfall {
namespace {

/// Among more candidates, only the squares whose mixed number is a multiple of kSampled are counted.
constexpr std::size_t kFewCandidates = 65536;
constexpr std::uint64_t kSampled = 16;

constexpr std::uint64_t kWhole = std::uint64_t{1} << 32U;  ///< an edge that holds all places

/// A hash (the finalizer of SplitMix64).
std::uint64_t mixed(std::uint64_t number) {
  number = (number ^ (number >> 30U)) * 0xbf58476d1ce4e5b9U;
  number = (number ^ (number >> 27U)) * 0x94d049bb133111ebU;
  return number ^ (number >> 31U);
}

}  // namespace

PointThinning::PointThinning(const PointPlace& low, const PointPlace& high, double cell_m,
                             std::size_t max_points)
    : low_(low), max_points_(max_points) {
  const double extent_m = std::max(high[0] - low[0], high[1] - low[1]);
  unit_m_ = extent_m > 0 ? extent_m / static_cast<double>(kWhole - 1) : 1;
  edge_ = static_cast<std::uint64_t>(std::clamp(cell_m / unit_m_, 1.0, static_cast<double>(kWhole)));
}

void PointThinning::add(const PointPlace& place, std::uint64_t row) {
  Candidate candidate{{}, row};
  for (std::size_t axis = 0; axis < 2; ++axis)
    candidate.place[axis] = static_cast<std::uint32_t>((place[axis] - low_[axis]) / unit_m_);
  candidates_.push_back(candidate);
  ++added_;
  if (candidates_.size() < 2 * kSpare * max_points_) return;
  while (true) {
    candidates_ = one_per_cell(candidates_, edge_);
    is_thinned_ = is_thinned_ || candidates_.size() < added_;
    if (candidates_.size() <= kSpare * max_points_) return;
    edge_ *= 2;
  }
}

std::uint64_t PointThinning::cell_of(const Candidate& candidate, std::uint64_t edge) {
  return (candidate.place[0] / edge << 32U) | candidate.place[1] / edge;
}

std::vector<PointThinning::Candidate> PointThinning::one_per_cell(const std::vector<Candidate>& candidates,
                                                                  std::uint64_t edge) {
  struct Ranked {
    std::uint64_t cell;
    std::uint64_t rank;
    std::uint32_t index;
  };
  std::vector<Ranked> ranked(candidates.size());
  parallel_for(ranked.size(), 65536, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      ranked[i] = {cell_of(candidates[i], edge), mixed(candidates[i].row), static_cast<std::uint32_t>(i)};
  });
  std::ranges::sort(ranked, [](const Ranked& a, const Ranked& b) {
    if (a.cell != b.cell) return a.cell < b.cell;
    return a.rank != b.rank ? a.rank < b.rank : a.index < b.index;
  });
  const auto same = [](const Ranked& a, const Ranked& b) { return a.cell == b.cell; };
  ranked.erase(std::unique(ranked.begin(), ranked.end(), same), ranked.end());
  std::ranges::sort(ranked, {}, &Ranked::index);
  return mapped(ranked, [&](const Ranked& r) { return candidates[r.index]; });
}

std::size_t PointThinning::cells(std::uint64_t edge) const {
  const std::uint64_t sampled = candidates_.size() > kFewCandidates ? kSampled : 1;
  std::vector<std::uint64_t> numbers;
  for (const Candidate& candidate : candidates_) {
    const std::uint64_t number = cell_of(candidate, edge);
    if (mixed(number) % sampled == 0) numbers.push_back(number);
  }
  std::ranges::sort(numbers);
  return sampled * static_cast<std::size_t>(std::unique(numbers.begin(), numbers.end()) - numbers.begin());
}

/// The smallest edge, within 2 %, of which no more squares than `max_points_` hold a candidate.
std::uint64_t PointThinning::last_edge() const {
  const auto scaled = [](std::uint64_t edge, double factor) {
    return static_cast<std::uint64_t>(static_cast<double>(edge) * factor) + 1;
  };
  std::uint64_t low = edge_;
  std::uint64_t high = edge_;
  while (high < kWhole && cells(high) > max_points_) {
    low = high;
    high *= 2;
  }
  while (scaled(low, 1.02) < high) {
    const std::uint64_t middle = scaled(low, std::sqrt(static_cast<double>(high) / static_cast<double>(low)));
    (cells(middle) > max_points_ ? low : high) = middle;
  }
  return high;
}

ThinnedPoints PointThinning::finish() {
  if (is_thinned_ || candidates_.size() > max_points_) {
    is_thinned_ = true;
    edge_ = last_edge();
    candidates_ = one_per_cell(candidates_, edge_);
    while (candidates_.size() > max_points_) {  // because cells() is not exact
      edge_ += edge_ / 64 + 1;
      candidates_ = one_per_cell(candidates_, edge_);
    }
  }
  ThinnedPoints result;
  result.cell_m = is_thinned_ ? unit_m_ * static_cast<double>(edge_) : 0;
  for (const Candidate& candidate : candidates_) result.rows.push_back(candidate.row);
  return result;
}

}  // namespace landfall
