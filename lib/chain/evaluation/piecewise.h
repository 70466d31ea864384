// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D63
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "base/core/parallel.h"

namespace landfall {

// Parallel loops and sums over as many values as a map has bins. The results are the same for any number of
// threads, because the pieces do not depend on it (D63).

inline constexpr std::size_t kValuesPerPiece = std::size_t{1} << 18U;

/// A function that gives the i-th value; NaN for one that does not count. Any thread may call it repeatedly.
template <class F>
concept ValueAt = std::is_invocable_r_v<double, const F&, std::size_t>;

/// Calls work(i) for each i of [0, count), on any thread.
template <class Work>
void for_each_index(std::size_t count, const Work& work) {
  parallel_for(count, kValuesPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) work(i);
  });
}

/// Calls work(begin, end) for each piece of [0, count), on any thread, and returns one result for each piece.
template <class Work>
[[nodiscard]] auto by_piece(std::size_t count, const Work& work) {
  std::vector<decltype(work(count, count))> results((count + kValuesPerPiece - 1) / kValuesPerPiece);
  parallel_for(count, kValuesPerPiece, [&](std::size_t begin, std::size_t end) {
    results[begin / kValuesPerPiece] = work(begin, end);
  });
  return results;
}

/// The number and the sum of the values that count.
struct CountedSum {
  std::int64_t count = 0;
  double sum = 0;
  void add(double value) {
    const bool counts = !std::isnan(value);
    count += counts ? 1 : 0;
    sum += counts ? value : 0.0;
  }
  /// NaN without any value.
  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
};

/// The sum of the pieces, in their order.
[[nodiscard]] inline CountedSum total(const std::vector<CountedSum>& pieces) {
  CountedSum result;
  for (const CountedSum& piece : pieces) {
    result.count += piece.count;
    result.sum += piece.sum;
  }
  return result;
}

/// The count and sum of the values 0 .. count - 1, by piece and then over the pieces.
template <ValueAt F>
[[nodiscard]] CountedSum counted_sum(std::size_t count, const F& value_at) {
  return total(by_piece(count, [&](std::size_t begin, std::size_t end) {
    CountedSum piece;
    for (std::size_t i = begin; i < end; ++i) piece.add(value_at(i));
    return piece;
  }));
}

}  // namespace landfall
