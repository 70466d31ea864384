// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/memory/zeroed_memory.h"
#include "chain/gridding/accumulator.h"
#include "chain/gridding/row_partition.h"
#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {

/// The return that represents a bin, or the mean of two, in methods that choose a return.
struct ChosenReturn {
  double z, x_true, y_true, x_est, y_est, t;
};

/// The lowest or the highest return of each bin (`min`, `max`): all values are those of that single return,
/// the first of several equal ones; `count` and `spread` cover all returns of the bin. A return belongs to
/// the bin whose centre is nearest. 80 bytes per bin; otherwise like WeightedMeanAccumulator.
class ExtremeAccumulator final : public Accumulator {
 public:
  enum class Which { lowest, highest };
  ExtremeAccumulator(const GridSpec& spec, Which which);

  void add(const GridPoints& points) override;
  void values(BinIndex first, std::span<BinValues> out) const override;

 private:
  /// Zero bytes are an empty bin.
  struct Bin {
    ChosenReturn chosen;
    double z_first, dz, dz_dz;  ///< sums relative to the first return, as in BinSums
    std::int32_t count;
  };
  [[nodiscard]] static BinValues values_of(const Bin& bin);
  void add_point(const GridPoints& points, std::size_t i, Bin& bin) const;

  Which which_;
  ZeroedArray<Bin> bins_;
  NearestBins nearest_;
};

/// Bilinear splatting (`bilinear4`): each return contributes to the four bin centres around its estimated
/// position, with the weight (1 - |x_est - X|/s)(1 - |y_est - Y|/s) at each, (X, Y) the centre; the four
/// weights add up to 1.
///
/// Centres outside the grid and centres with weight 0 are skipped: a return exactly on a column or row of
/// centres contributes to two bins, a return on a centre to one. The count of every bin that a return reaches
/// includes it; inside_count counts it once. Order and memory (16 bytes per point and pass) are as in
/// WeightedMeanAccumulator.
class BilinearAccumulator final : public Accumulator {
 public:
  explicit BilinearAccumulator(const GridSpec& spec);

  void add(const GridPoints& points) override;
  void values(BinIndex first, std::span<BinValues> out) const override;

 private:
  void add_pass(const GridPoints& points);
  void add_band(const GridPoints& points, std::size_t band);
  void add_to_row(const GridPoints& points, std::size_t i, bool north);

  ZeroedArray<BinSums> bins_;
  RowPartition south_;  ///< by the row of the two centres below a return
  RowPartition north_;  ///< by the row of the two centres above a return
};

/// The median return of each bin by z_est (`median`), equal ones in order of arrival: all values are those of
/// that single return or, for an even count, the means of the middle two; `count` and `spread` cover all
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
