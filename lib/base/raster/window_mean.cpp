// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D27
#include "base/raster/window_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/core/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "base/raster/window_mean.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Columns summed at a time, in registers: four vectors hide the latency of an addition.
constexpr std::int64_t kVectorLanes = static_cast<std::int64_t>(hn::MaxLanes(D()));
constexpr std::int64_t kLanes = 4 * kVectorLanes;

template <class T>
using Lanes = std::array<T, kLanes>;

/// The sums of kLanes columns.
struct LaneSums {
  V v0, v1, v2, v3;

  HWY_INLINE LaneSums() : v0(hn::Zero(D())), v1(v0), v2(v0), v3(v0) {}
  HWY_INLINE void Add(const double* values) {
    v0 = hn::Add(v0, hn::LoadU(D(), values));
    v1 = hn::Add(v1, hn::LoadU(D(), values + kVectorLanes));
    v2 = hn::Add(v2, hn::LoadU(D(), values + 2 * kVectorLanes));
    v3 = hn::Add(v3, hn::LoadU(D(), values + 3 * kVectorLanes));
  }
  HWY_INLINE void Store(double* target) const {
    hn::StoreU(v0, D(), target);
    hn::StoreU(v1, D(), target + kVectorLanes);
    hn::StoreU(v2, D(), target + 2 * kVectorLanes);
    hn::StoreU(v3, D(), target + 3 * kVectorLanes);
  }
};

inline std::int64_t whole_lanes(std::int64_t cols) { return (cols + kLanes - 1) / kLanes * kLanes; }

/// Contiguous rows of the same width.
template <class T>
class RowBuffer {
 public:
  RowBuffer(std::int64_t rows, std::int64_t width)
      : width_(width), values_(static_cast<std::size_t>(rows * width)) {}
  [[nodiscard]] T* row(std::int64_t row) { return values_.data() + row * width_; }
  [[nodiscard]] const T* row(std::int64_t row) const { return values_.data() + row * width_; }

 private:
  std::int64_t width_;
  std::vector<T> values_;
};

/// The windows centred on the rows begin .. end - 1, and the rows first .. last - 1 that they reach.
struct Band {
  std::int64_t begin, end;
  std::int64_t first, last;
};

/// The means of one band of windows.
class BandMeans {
 public:
  BandMeans(const Grid<double>& values, const Footprint& footprint, const Band& band)
      : values_(values),
        footprint_(footprint),
        band_(band),
        reach_(std::min(footprint.half_bins(), values.spec().cols - 1)),
        width_(whole_lanes(values.spec().cols)) {}

  void write(WindowMeans& result) const {
    write_counts(result.count);
    if (footprint_.is_square())
      write_square_sums(result.mean);
    else
      write_sums(result.mean);
    for (std::int64_t row = band_.begin; row < band_.end; ++row)
      divide(result.mean.row(row), result.count.row(row));
  }

 private:
  /// Reads a row with NaN as +0 and reach_ zeros before and after it.
  void read_row(std::int64_t row, std::vector<double>& padded) const {
    const std::span<const double> in = values_.row(row);
    double* const out = padded.data() + reach_;
    for (std::size_t c = 0; c < in.size(); ++c) out[c] = std::isnan(in[c]) ? 0.0 : in[c];
  }
  [[nodiscard]] std::vector<double> padded_row() const {
    return std::vector<double>(static_cast<std::size_t>(width_ + 2 * reach_));
  }

  /// For each row that the band reaches, at column c + reach_: the number of valid bins before column c.
  [[nodiscard]] RowBuffer<std::int32_t> counts_before() const {
    RowBuffer<std::int32_t> result(band_.last - band_.first, width_ + 2 * reach_ + 1);
    for (std::int64_t row = band_.first; row < band_.last; ++row) {
      const std::span<const double> in = values_.row(row);
      std::int32_t* const before = result.row(row - band_.first) + reach_;
      std::int32_t count = 0;
      for (std::size_t c = 0; c < in.size(); ++c) before[c + 1] = count += std::isnan(in[c]) ? 0 : 1;
      std::fill(before + in.size(), before + width_ + reach_ + 1, count);
    }
    return result;
  }

  /// Counts are exact in any order, so those of a square slide from row to row.
  void write_counts(Grid<std::int32_t>& result) const {
    const RowBuffer<std::int32_t> before = counts_before();
    for (std::int64_t col = 0; col < width_; col += kLanes) {
      Lanes<std::int32_t> counts{};
      for (std::int64_t row = band_.begin; row < band_.end; ++row) {
        const auto count_row = [&](std::int64_t r, std::int32_t sign) {
          const std::int64_t span = footprint_.is_square() ? reach_ : half_width(r - row);
          const std::int32_t* const at = before.row(r - band_.first) + reach_ + col;
          for (std::size_t lane = 0; lane < kLanes; ++lane)
            counts[lane] += sign * ((at + span + 1)[lane] - (at - span)[lane]);
        };
        if (footprint_.is_square() && row > band_.begin) {
          slide(row, count_row);
        } else {
          counts = {};
          const RowRange rows = rows_of(row);
          for (std::int64_t r = rows.begin; r < rows.end; ++r) count_row(r, 1);
        }
        store(counts, result, {row, col});
      }
    }
  }

  /// Counts the row that the windows centred on `row` newly reach with +1, the one that they left with -1.
  template <class CountRow>
  void slide(std::int64_t row, const CountRow& count_row) const {
    const std::int64_t entering = row + footprint_.half_bins();
    const std::int64_t leaving = row - footprint_.half_bins() - 1;
    if (entering < band_.last) count_row(entering, 1);
    if (leaving >= band_.first) count_row(leaving, -1);
  }

  void write_square_sums(Grid<double>& result) const {
    RowBuffer<double> row_sums(band_.last - band_.first, width_);
    std::vector<double> padded = padded_row();
    for (std::int64_t row = band_.first; row < band_.last; ++row) {
      read_row(row, padded);
      for (std::int64_t col = 0; col < width_; col += kLanes) {
        LaneSums sums;
        for (std::int64_t c = col; c <= col + 2 * reach_; ++c) sums.Add(padded.data() + c);
        sums.Store(row_sums.row(row - band_.first) + col);
      }
    }
    for (std::int64_t col = 0; col < width_; col += kLanes)
      for (std::int64_t row = band_.begin; row < band_.end; ++row) add_rows(row_sums, {row, col}, result);
  }

  void add_rows(const RowBuffer<double>& row_sums, BinIndex first, Grid<double>& result) const {
    LaneSums sums;
    const RowRange rows = rows_of(first.row);
    for (std::int64_t r = rows.begin; r < rows.end; ++r) sums.Add(row_sums.row(r - band_.first) + first.col);
    Lanes<double> lanes;
    sums.Store(lanes.data());
    store(lanes, result, first);
  }

  /// Each row that the band reaches is summed outwards once; each of its spans is added to the windows that
  /// hold the row with that width, from the lowest row up.
  void write_sums(Grid<double>& result) const {
    for (std::int64_t row = band_.begin; row < band_.end; ++row) std::ranges::fill(result.row(row), 0.0);
    std::vector<double> padded = padded_row();
    std::vector<double> sums(static_cast<std::size_t>(values_.spec().cols));
    for (std::int64_t row = band_.first; row < band_.last; ++row) {
      read_row(row, padded);
      // Visits the windows that hold the row with the current width.
      std::int64_t offset = std::min(footprint_.half_bins(), values_.spec().rows - 1);
      for (std::int64_t width = 0; width <= reach_; ++width) {
        widen(padded, width, sums);
        for (; offset >= 0 && half_width(offset) == width; --offset) {
          add_to_row(sums, row - offset, result);
          if (offset > 0) add_to_row(sums, row + offset, result);
        }
      }
    }
  }

  /// Computes the sums from those of the next smaller width.
  void widen(const std::vector<double>& padded, std::int64_t width, std::span<double> sums) const {
    const double* const left = padded.data() + reach_ - width;
    const double* const right = padded.data() + reach_ + width;
    for (std::size_t c = 0; c < sums.size(); ++c)
      sums[c] = width == 0 ? 0.0 + left[c] : (sums[c] + left[c]) + right[c];
  }

  [[nodiscard]] std::int64_t half_width(std::int64_t offset) const {
    return std::min(footprint_.half_width(offset), reach_);
  }

  void add_to_row(std::span<const double> sums, std::int64_t centre, Grid<double>& result) const {
    if (centre < band_.begin || centre >= band_.end) return;
    double* const target = result.row(centre).data();
    for (std::size_t c = 0; c < sums.size(); ++c) target[c] += sums[c];
  }

  struct RowRange {
    std::int64_t begin, end;
  };

  /// The rows of the grid that the windows centred on `row` reach.
  [[nodiscard]] RowRange rows_of(std::int64_t row) const {
    return {std::max(row - footprint_.half_bins(), band_.first),
            std::min(row + footprint_.half_bins() + 1, band_.last)};
  }

  template <class T>
  static void store(const Lanes<T>& lanes, Grid<T>& grid, BinIndex first) {
    const std::span<T> row = grid.row(first.row).subspan(static_cast<std::size_t>(first.col));
    std::copy_n(lanes.begin(), std::min(lanes.size(), row.size()), row.begin());
  }

  static void divide(std::span<double> sums, std::span<const std::int32_t> counts) {
    for (std::size_t c = 0; c < sums.size(); ++c)
      sums[c] = counts[c] == 0 ? std::numeric_limits<double>::quiet_NaN() : sums[c] / counts[c];
  }

  const Grid<double>& values_;
  const Footprint& footprint_;
  Band band_;
  std::int64_t reach_;  ///< the most columns on either side that a window holds
  std::int64_t width_;  ///< columns, rounded up to whole vectors
};

void WriteBand(const Grid<double>& values, const Footprint& footprint, std::int64_t begin, std::int64_t end,
               WindowMeans& result) {
  Band band{begin, end, 0, 0};
  band.first = std::max<std::int64_t>(band.begin - footprint.half_bins(), 0);
  band.last = std::min(band.end + footprint.half_bins(), values.spec().rows);
  BandMeans(values, footprint, band).write(result);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {
namespace {

constexpr std::size_t kRowsPerTask = 128;

}  // namespace

HWY_EXPORT(WriteBand);

WindowMeans window_means(const Grid<double>& values, const Footprint& footprint) {
  const GridSpec& spec = values.spec();
  WindowMeans result{Grid<double>::unset(spec), Grid<std::int32_t>::unset(spec)};
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerTask, [&](std::size_t begin, std::size_t end) {
    HWY_DYNAMIC_DISPATCH(WriteBand)
    (values, footprint, static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end), result);
  });
  return result;
}

}  // namespace landfall
#endif
