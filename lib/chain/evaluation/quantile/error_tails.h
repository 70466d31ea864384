// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/raster/footprint.h"
#include "base/raster/grid.h"
#include "chain/evaluation/quantile/bucket_sort.h"

namespace landfall {

/// A rectangle of bins: the bins on which windows are centred, or those that the windows reach.
struct Tile {
  std::int64_t first_row = 0;
  std::int64_t first_col = 0;
  std::int64_t rows = 0;
  std::int64_t cols = 0;
};

/// The bins of the tile's windows of 2 half_bins + 1 bins square, clipped at the grid's border.
[[nodiscard]] Tile reach(const GridSpec& spec, const Tile& tile, std::int64_t half_bins);

/// One side of the errors that a tile's windows reach: the bins with the largest sign * e, sorted, and the
/// sets of them in each window. A window's members are the intersection of two bit sets, its row's and its
/// column's: for a square, the bins in the rows and in the columns of the window; for another footprint the
/// row's set holds all bins, and the columns' sets are rebuilt for each row of windows.
///
/// Ranks in the sorted list count from kPad. kPad elements of +infinity precede the first bin and kPad
/// elements of -infinity follow the last; the two elements next to the bins are members of every window, so
/// that a search for a member always ends.
class ErrorTail {
 public:
  static constexpr std::size_t kPad = 16;

  /// Bins with sign * e, to be filled before build().
  std::vector<TailBin> bins;

  /// Sorts the bins. The footprint must outlive this object.
  void build(const Tile& tile, const Footprint& footprint);
  /// Prepares the sets of a row of the tile's windows.
  void enter_row(std::int64_t row);

  [[nodiscard]] std::size_t size() const { return bins.size(); }
  /// In descending order, with the padding.
  [[nodiscard]] const double* values() const { return values_.data(); }
  /// The sets of the entered row or of a column, words() long; bit p is rank p.
  [[nodiscard]] const std::uint64_t* row_set() const { return set(row_sets_, entered_set_); }
  [[nodiscard]] const std::uint64_t* col_set(std::int64_t col) const { return set(col_sets_, col); }
  [[nodiscard]] std::size_t words() const { return words_; }

 private:
  using Sets = std::vector<std::uint64_t>;

  [[nodiscard]] const std::uint64_t* set(const Sets& sets, std::int64_t index) const {
    return sets.data() + static_cast<std::size_t>(index) * words_;
  }
  void draw_square_sets();
  void draw_spans(std::int64_t row);

  std::vector<double> values_;
  BucketSort sort_;
  Sets row_sets_, col_sets_;
  Tile tile_;
  const Footprint* footprint_ = nullptr;
  std::int64_t entered_set_ = 0;
  std::size_t words_ = 0;
};

/// The bins whose deviation from the mean of some window may be large.
struct ErrorTails {
  ErrorTail upper;  ///< sign +1
  ErrorTail lower;  ///< sign -1
};

/// The bins that a tail keeps: those outside the open interval.
struct TailBounds {
  double upper = 0;  ///< keeps e >= upper
  double lower = 0;  ///< and e <= lower; a bin may be both
};

void collect_tails(const Grid<double>& error, const Tile& reached, const TailBounds& bounds,
                   ErrorTails& tails);

/// The number of set bits. Without the machine instruction, std::popcount is a call into the compiler's
/// library, and a build for generic x86-64 may not use the instruction.
[[nodiscard]] inline std::size_t count_bits(std::uint64_t set) {
#ifdef __POPCNT__
  return static_cast<std::size_t>(std::popcount(set));
#else
  set -= (set >> 1U) & 0x5555555555555555U;
  set = (set & 0x3333333333333333U) + ((set >> 2U) & 0x3333333333333333U);
  set = (set + (set >> 4U)) & 0x0f0f0f0f0f0f0f0fU;
  return static_cast<std::size_t>((set * 0x0101010101010101U) >> 56U);
#endif
}

/// The members of one window in one tail. Ranks are those of the padded tail.
class TailMembers {
 public:
  /// In the tail's entered row.
  TailMembers(const ErrorTail& tail, std::int64_t col) : row_(tail.row_set()), col_(tail.col_set(col)) {}

  /// The number of members before the rank, including a padding element.
  [[nodiscard]] std::size_t count_before(std::size_t rank) const {
    const std::size_t word = rank / 64;
    std::size_t count = count_bits(in_word(word) & ~from(rank));
    for (std::size_t w = 0; w < word; ++w) count += count_bits(in_word(w));
    return count;
  }

  /// The first member at the rank or after it.
  [[nodiscard]] std::size_t next(std::size_t rank) const {
    std::size_t word = rank / 64;
    std::uint64_t set = in_word(word) & from(rank);
    while (set == 0) set = in_word(++word);
    return word * 64 + static_cast<std::size_t>(std::countr_zero(set));
  }

  /// The last member before the rank.
  [[nodiscard]] std::size_t previous(std::size_t rank) const {
    std::size_t word = rank / 64;
    std::uint64_t set = in_word(word) & ~from(rank);
    while (set == 0) set = in_word(--word);
    return word * 64 + 63 - static_cast<std::size_t>(std::countl_zero(set));
  }

  struct Run {
    std::size_t first = 0;
    std::size_t last = 0;
    std::size_t count = 0;
  };

  /// The members of one word of the set, from the given one on.
  [[nodiscard]] Run rest_of_word(std::size_t member) const {
    return run(member / 64, in_word(member / 64) & from(member));
  }
  /// The members of one word of the set, up to the given one.
  [[nodiscard]] Run start_of_word(std::size_t member) const {
    return run(member / 64, in_word(member / 64) & ~(from(member) << 1U));
  }

 private:
  static Run run(std::size_t word, std::uint64_t set) {
    return {word * 64 + static_cast<std::size_t>(std::countr_zero(set)),
            word * 64 + 63 - static_cast<std::size_t>(std::countl_zero(set)), count_bits(set)};
  }
  [[nodiscard]] std::uint64_t in_word(std::size_t word) const { return row_[word] & col_[word]; }
  /// The bits of the rank's word from the rank on.
  static std::uint64_t from(std::size_t rank) { return ~std::uint64_t{0} << (rank % 64); }

  const std::uint64_t* row_;
  const std::uint64_t* col_;
};

}  // namespace landfall
