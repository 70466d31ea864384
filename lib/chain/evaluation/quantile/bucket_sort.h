// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace landfall {

/// A bin and its error, multiplied by the sign of the tail.
struct TailBin {
  double value = 0;
  std::int32_t row = 0;
  std::int32_t col = 0;
};

/// Sorts bins by descending value; values are finite. They are distributed over as many buckets of equal
/// width as there are bins, which takes half the time of a plain sort for noise-like errors. A crowded bucket
/// is distributed again: errors may cluster at several scales, for example rounding on flat terrain and the
/// cell size on a slope.
class BucketSort {
 public:
  void sort(std::span<TailBin> bins) { sort(bins, 0); }

 private:
  static constexpr std::size_t kLevels = 3;  // then a plain sort, which clustered values do not slow down

  /// Maps a value to its bucket. All buckets have the same width.
  struct Buckets {
    double highest = 0;
    double per_unit = 0;
    [[nodiscard]] std::size_t of(const TailBin& bin) const {
      return static_cast<std::size_t>((highest - bin.value) * per_unit);
    }
  };

  struct Level {
    std::vector<TailBin> dealt;
    std::vector<std::size_t> ends;  ///< ends of the buckets; during filling, their next free elements
  };

  void sort(std::span<TailBin> bins, std::size_t level);
  static Buckets buckets_for(std::span<const TailBin> bins);
  static void deal(std::span<TailBin> bins, const Buckets& buckets, Level& level);

  std::array<Level, kLevels> levels_;
};

}  // namespace landfall
