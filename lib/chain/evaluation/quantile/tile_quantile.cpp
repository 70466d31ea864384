// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/tile_quantile.h"

#include <algorithm>
#include <cmath>

#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

// Chosen for speed; none of them changes a result.
constexpr double kCaution = 0.93;  // first floor, as a fraction of the smallest known answer
constexpr double kRetreat = 0.5;   // second floor, as a fraction of the first, if that left too few bins
constexpr int kWalkAttempts = 3;   // before a tile is split
constexpr double kCrowded = 20;    // split if the tails are this many times as large as needed
constexpr std::int64_t kSmallestEdge = 4;  // of a tile that is not split further

struct MeanInterval {
  double lowest = kInfinity;
  double highest = -kInfinity;
};

template <class Visit>
void for_each_bin(const Tile& tile, Visit visit) {
  for (std::int64_t row = tile.first_row; row < tile.first_row + tile.rows; ++row)
    for (std::int64_t col = tile.first_col; col < tile.first_col + tile.cols; ++col)
      visit(BinIndex{row, col});
}

bool is_small(const Tile& tile) { return tile.rows <= kSmallestEdge && tile.cols <= kSmallestEdge; }

/// Half an edge; the whole edge if the other is more than twice as long or the half would be too small.
std::int64_t split_edge(std::int64_t edge, std::int64_t other) {
  return edge <= kSmallestEdge || other > 2 * edge ? edge : (edge + 1) / 2;
}

}  // namespace

TileQuantile::TileQuantile(const WindowQuantileInput& input, Grid<double>& result)
    : input_(input), result_(result), selection_(input), walk_(input, result) {}

bool TileQuantile::pending(BinIndex bin) const { return is_pending(input_, result_, bin); }

std::optional<BinIndex> TileQuantile::some_pending(const Tile& tile) const {
  for (std::int64_t row = tile.first_row; row < tile.first_row + tile.rows; ++row)
    for (std::int64_t col = tile.first_col; col < tile.first_col + tile.cols; ++col)
      if (pending({row, col})) return BinIndex{row, col};
  return std::nullopt;
}

void TileQuantile::compute(const Tile& tile) {
  const std::optional<BinIndex> first = some_pending(tile);
  if (!first || fill_uniform(tile)) {
    guess_.reset();
    return;
  }
  smallest_ = kInfinity;
  compute_above(tile, guess_ ? *guess_ : guess_from(*first));
  guess_ = kCaution * smallest_;
}

bool TileQuantile::fill_uniform(const Tile& tile) {
  const Tile reached = reach(input_.error.spec(), tile, input_.footprint.half_bins());
  std::optional<double> only;
  for (std::int64_t row = reached.first_row; row < reached.first_row + reached.rows; ++row)
    for (std::int64_t col = reached.first_col; col < reached.first_col + reached.cols; ++col) {
      const double e = input_.error.at({row, col});
      if (std::isnan(e)) continue;
      if (only && *only != e) return false;
      only = e;
    }
  for_each_bin(tile, [&](BinIndex bin) {
    if (pending(bin)) result_.at(bin) = std::abs(*only - input_.windows.mean.at(bin));
  });
  return true;
}

void TileQuantile::select(BinIndex bin) {
  result_.at(bin) = selection_.at(bin);
  smallest_ = std::min(smallest_, result_.at(bin));
}

double TileQuantile::guess_from(BinIndex bin) {
  select(bin);
  return kCaution * result_.at(bin);
}

void TileQuantile::compute_above(const Tile& tile, double floor) {
  for (int attempt = 0; attempt < kWalkAttempts; ++attempt) {
    WalkOutcome outcome;
    if (!walk_above(tile, floor, outcome)) break;
    if (outcome.uncertified == 0) return;
    floor = outcome.lower_bound > 0 ? outcome.lower_bound : kRetreat * floor;
  }
  if (is_small(tile))
    select_pending(tile);
  else
    compute_quarters(tile);
}

/// Returns false if the tails would be too large.
bool TileQuantile::walk_above(const Tile& tile, double floor, WalkOutcome& outcome) {
  MeanInterval means;
  for_each_bin(tile, [&](BinIndex bin) {
    if (!pending(bin)) return;
    means.lowest = std::min(means.lowest, input_.windows.mean.at(bin));
    means.highest = std::max(means.highest, input_.windows.mean.at(bin));
  });
  const TailBounds bounds =
      floor > 0 ? TailBounds{means.lowest + floor, means.highest - floor} : TailBounds{-kInfinity, kInfinity};
  const Tile reached = reach(input_.error.spec(), tile, input_.footprint.half_bins());
  collect_tails(input_.error, reached, bounds, tails_);
  const auto needed = (1 - input_.quantile) * static_cast<double>(reached.rows * reached.cols);
  const auto found = static_cast<double>(tails_.upper.size() + tails_.lower.size());
  if (!is_small(tile) && found > kCrowded * needed + 64) return false;
  tails_.upper.build(tile, input_.footprint);
  tails_.lower.build(tile, input_.footprint);
  outcome = walk_.run(tails_, tile, floor);
  smallest_ = std::min(smallest_, outcome.smallest);
  return true;
}

void TileQuantile::compute_quarters(const Tile& tile) {
  const std::int64_t rows = split_edge(tile.rows, tile.cols);
  const std::int64_t cols = split_edge(tile.cols, tile.rows);
  for (std::int64_t row = 0; row < tile.rows; row += rows) {
    for (std::int64_t col = 0; col < tile.cols; col += cols) {
      const Tile quarter{tile.first_row + row, tile.first_col + col, std::min(rows, tile.rows - row),
                         std::min(cols, tile.cols - col)};
      const std::optional<BinIndex> first = some_pending(quarter);
      if (!first) continue;
      const double floor = guess_from(*first);
      if (some_pending(quarter)) compute_above(quarter, floor);
    }
  }
}

void TileQuantile::select_pending(const Tile& tile) {
  for_each_bin(tile, [&](BinIndex bin) {
    if (pending(bin)) select(bin);
  });
}

}  // namespace landfall
