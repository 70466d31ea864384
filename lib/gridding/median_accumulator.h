// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/zeroed_memory.h"
#include "gridding/accumulator.h"
#include "gridding/chosen_return.h"

namespace landfall {

/// The median return of each bin by z_est (`median`), equal ones in order of arrival: all values are those of
/// that single return or, for an even count, the means of the middle two; count and z_spread cover all
/// returns of the bin. A return belongs to the bin whose centre is nearest.
///
/// Medians need every return of a bin at once, so this method sees all returns several times: the first pass
/// counts them by row of bins, each further pass gathers and sorts the returns of the next rows, at most
/// `points_at_a_time`. 56 bytes per bin and 64 per gathered return: 224 + 134 MB for 2001 x 2001 bins, for
/// any number of returns.
class MedianAccumulator final : public Accumulator {
 public:
  static constexpr std::int64_t kPointsAtATime = std::int64_t{1} << 21U;
  explicit MedianAccumulator(const GridSpec& spec, std::int64_t points_at_a_time = kPointsAtATime);

  void add(const GridPoints& points) override;
  /// Throws FormatError after the first pass if one row of bins holds more than points_at_a_time
  /// returns.
  bool end_pass() override;
  /// The first pass counts as a tenth of the progress: the number of passes is unknown before it ends.
  [[nodiscard]] double progress(double pass_fraction) const override;
  void values(BinIndex first, std::span<BinValues> out) const override;

 private:
  struct Return {
    double z, x_true, y_true, x_est, y_est, t;
    std::uint64_t bin;
    std::uint64_t number;  ///< order of arrival among those gathered, which breaks ties of elevation
  };
  /// Zero bytes are an empty bin.
  struct Bin {
    ChosenReturn chosen;
    float spread;
    std::int32_t count;
  };
  void count_row(const GridPoints& points);
  void gather(const GridPoints& points);
  void plan();
  void find_medians();
  [[nodiscard]] static Bin median_of(std::span<const Return> sorted);
  [[nodiscard]] static BinValues values_of(const Bin& bin);

  std::int64_t points_at_a_time_;
  ZeroedArray<Bin> bins_;
  std::vector<std::int64_t> row_counts_;
  std::vector<std::int64_t> band_rows_;  ///< the first row of each band, and the end of the last
  std::size_t pass_ = 0;                 ///< 0 counts; pass i gathers band i - 1
  std::vector<Return> gathered_;
};

}  // namespace landfall
