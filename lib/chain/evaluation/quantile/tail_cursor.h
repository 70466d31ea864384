// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>

#include "chain/evaluation/quantile/error_tails.h"

namespace landfall {

/// One window in one tail: a rank that splits the window's members into those taken (before it) and those
/// left. Deviations are value - centre, rounded once; they do not increase along the tail. The padding has an
/// infinite deviation.
class TailCursor {
 public:
  struct Window {
    std::int64_t col = 0;  ///< in the row of the tile that the tail has entered
    double centre = 0;     ///< the window's mean times the tail's sign
  };

  TailCursor(const ErrorTail& tail, const Window& window, std::size_t rank)
      : values_(tail.values()), members_(tail, window.col), centre_(window.centre), rank_(rank) {}

  [[nodiscard]] std::size_t count_taken() const { return members_.count_before(rank_); }
  /// Deviation of the first member left.
  [[nodiscard]] double next_deviation() const { return deviation(members_.next(rank_)); }
  /// Deviation of the last member taken.
  [[nodiscard]] double previous_deviation() const { return deviation(members_.previous(rank_)); }

  /// Takes at least one of the members left, but no padding: one member, or the members of a word if there
  /// are at most `maximum` of them and none deviates by less than `minimum`. Returns the number taken.
  std::size_t take(std::size_t maximum, double minimum) {
    const std::size_t first = members_.next(rank_);
    if (maximum > kFew) {
      const TailMembers::Run run = members_.rest_of_word(first);
      const double deviation_of_last = deviation(run.last);
      if (run.count <= maximum && deviation_of_last >= minimum && std::isfinite(deviation_of_last)) {
        rank_ = run.last + 1;
        return run.count;
      }
    }
    rank_ = first + 1;
    return 1;
  }

  /// The reverse of take(): returns members that were taken, none of which deviates by more than `largest`.
  std::size_t give_back(std::size_t maximum, double largest) {
    const std::size_t last = members_.previous(rank_);
    if (maximum > kFew) {
      const TailMembers::Run run = members_.start_of_word(last);
      const double deviation_of_first = deviation(run.first);
      if (run.count <= maximum && deviation_of_first <= largest && std::isfinite(deviation_of_first)) {
        rank_ = run.first;
        return run.count;
      }
    }
    rank_ = last;
    return 1;
  }

 private:
  /// Up to this number, members are moved one at a time.
  static constexpr std::size_t kFew = 8;

  [[nodiscard]] double deviation(std::size_t rank) const { return values_[rank] - centre_; }

  const double* values_;
  TailMembers members_;
  double centre_;
  std::size_t rank_;
};

}  // namespace landfall
