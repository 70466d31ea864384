// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/quantile/tail_walk.h"

#include <algorithm>

#include "base/numerics/non_finite.h"
#include "chain/evaluation/quantile/quantile.h"
#include "chain/evaluation/quantile/tail_cursor.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/evaluation/quantile/tail_walk.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Moves a rank so that exactly the values before it deviate from the centre by more than the limit, which is
/// finite. Both tails are split by the rounded deviation itself: a sum like centre + limit has a rounding
/// error of its own, so the tails would disagree about nearly equal deviations. Most moves are short: the
/// sixteen values around the rank are compared without a branch.
inline std::size_t part(const ErrorTail& tail, std::size_t rank, double centre, double limit) {
  constexpr std::size_t kReach = 8;
  static_assert(kReach <= ErrorTail::kPad / 2);
  const double* const values = tail.values();
  const double* const around = values + rank - kReach;
  const auto centres = hn::Set(D(), centre);
  const auto limits = hn::Set(D(), limit);
  std::size_t above = 0;
  for (std::size_t i = 0; i < 2 * kReach; i += hn::Lanes(D()))
    above += hn::CountTrue(D(), hn::Gt(hn::Sub(hn::LoadU(D(), around + i), centres), limits));
  if (above > 0 && above < 2 * kReach) return rank - kReach + above;
  const double* const end = values + tail.size() + 2 * ErrorTail::kPad;
  const double* const parted =
      std::partition_point(values, end, [&](double v) { return v - centre > limit; });
  return static_cast<std::size_t>(parted - values);
}

/// One walk over the windows of a tile.
class Walk {
 public:
  /// above: the order statistics of the previous row of windows, one per column of the tile.
  Walk(const WindowQuantileInput& input, Grid<double>& result, double floor, std::vector<double>& above)
      : input_(input), result_(result), floor_(floor), above_(above) {}

  WalkOutcome run(ErrorTails& tails, const Tile& tile) {
    for (std::int64_t row = 0; row < tile.rows; ++row) walk_row(tails, tile, row);
    return outcome_;
  }

 private:
  struct OrderStatistics {
    double below = 0;  ///< -infinity when the tails hold too few bins
    double above = 0;
  };
  struct Ranks {
    std::size_t upper = ErrorTail::kPad;
    std::size_t lower = ErrorTail::kPad;
  };

  void walk_row(ErrorTails& tails, const Tile& tile, std::int64_t row);
  [[nodiscard]] double settle(BinIndex bin, const OrderStatistics& found);
  [[nodiscard]] OrderStatistics find(TailCursor upper, TailCursor lower) const;
  void look_up_rank(BinIndex bin);

  const WindowQuantileInput& input_;
  Grid<double>& result_;
  double floor_;
  std::vector<double>& above_;
  WalkOutcome outcome_;
  Ranks ranks_;  ///< where the last window was split
  std::int32_t rank_count_ = 0;
  QuantileRank rank_;  ///< of rank_count_ values
};

inline void Walk::walk_row(ErrorTails& tails, const Tile& tile, std::int64_t row) {
  tails.upper.enter_row(row);
  tails.lower.enter_row(row);
  double left = above_[0];
  double above_left = above_[0];
  for (std::int64_t col = 0; col < tile.cols; ++col) {
    const BinIndex bin{tile.first_row + row, tile.first_col + col};
    double& above = above_[static_cast<std::size_t>(col)];
    const double predicted = std::max(left + (above - above_left), 0.0);
    above_left = above;
    left = above;
    if (!is_pending(input_, result_, bin)) continue;
    look_up_rank(bin);
    const double mean = input_.windows.mean.at(bin);
    ranks_ = {part(tails.upper, ranks_.upper, mean, predicted),
              part(tails.lower, ranks_.lower, -mean, predicted)};
    left = settle(bin,
                  find({tails.upper, {col, mean}, ranks_.upper}, {tails.lower, {col, -mean}, ranks_.lower}));
    above = left;
  }
}

inline void Walk::look_up_rank(BinIndex bin) {
  const std::int32_t count = input_.windows.count.at(bin);
  if (count == rank_count_) return;
  rank_count_ = count;
  rank_ = quantile_rank(static_cast<std::size_t>(count), input_.quantile);
}

/// Everything above the lower order statistic is taken; the two statistics are the members at the split.
inline Walk::OrderStatistics Walk::find(TailCursor upper, TailCursor lower) const {
  // One padding element in each tail is always taken.
  const std::size_t target = static_cast<std::size_t>(rank_count_) - 1 - rank_.below + 2;
  std::size_t taken = upper.count_taken() + lower.count_taken();
  while (taken > target) {
    const double u = upper.previous_deviation();
    const double l = lower.previous_deviation();
    taken -= u <= l ? upper.give_back(taken - target, l) : lower.give_back(taken - target, u);
  }
  while (taken < target) {
    const double u = upper.next_deviation();
    const double l = lower.next_deviation();
    if (std::max(u, l) == -kInfinity) break;
    taken += u >= l ? upper.take(target - taken, l) : lower.take(target - taken, u);
  }
  return {std::max(upper.next_deviation(), lower.next_deviation()),
          std::min(upper.previous_deviation(), lower.previous_deviation())};
}

inline double Walk::settle(BinIndex bin, const OrderStatistics& found) {
  if (!(found.below >= floor_)) {
    ++outcome_.uncertified;
    outcome_.lower_bound = std::min(outcome_.lower_bound, found.below);
    return std::max(found.below, 0.0);
  }
  outcome_.smallest = std::min(outcome_.smallest, found.below);
  result_.at(bin) = rank_.frac == 0 ? found.below : interpolate(found.below, found.above, rank_.frac);
  return found.below;
}

WalkOutcome RunWalk(const WindowQuantileInput& input, Grid<double>& result, ErrorTails& tails,
                    const Tile& tile, double floor, std::vector<double>& above) {
  return Walk(input, result, floor, above).run(tails, tile);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(RunWalk);

WalkOutcome TailWalk::run(ErrorTails& tails, const Tile& tile, double floor) {
  above_.assign(static_cast<std::size_t>(tile.cols), floor);
  return HWY_DYNAMIC_DISPATCH(RunWalk)(input_, result_, tails, tile, floor, above_);
}

}  // namespace landfall
#endif
