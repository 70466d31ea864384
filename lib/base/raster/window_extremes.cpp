// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/window_extremes.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

constexpr double kLowest = -std::numeric_limits<double>::infinity();
constexpr std::size_t kRowsPerStrip = 32;
constexpr std::size_t kColsPerPiece = 64;  // side by side in one pass along columns

/// Samples along a line, each of `lanes` neighbouring values; `step` from one sample to the next.
template <class T>
struct Line {
  T* values;
  std::int64_t count, step;
  std::size_t lanes;
  [[nodiscard]] T* at(std::int64_t i) const { return values + i * step; }
};

/// The largest of 2 half + 1 samples about each. Lines are cut into blocks of as many samples: a window is
/// the end of one block and the beginning of the next.
class LineMaxima {
 public:
  LineMaxima(std::int64_t half, std::size_t lanes)
      : half_(half), lanes_(lanes), ends_(static_cast<std::size_t>(2 * half + 1) * lanes), begin_(lanes) {}

  void find(const Line<const double>& in, const Line<double>& out) {
    const std::int64_t width = 2 * half_ + 1;
    for (std::int64_t first = 0; first < in.count; first += width) {
      find_ends(in, first - half_);
      std::ranges::fill(begin_, kLowest);
      for (std::int64_t i = 0; i < width && first + i < in.count; ++i) {
        if (i > 0) widen(in, first + half_ + i, begin_.data());
        const double* const end = end_at(i);
        double* const target = out.at(first + i);
        for (std::size_t k = 0; k < lanes_; ++k) target[k] = std::max(end[k], begin_[k]);
      }
    }
  }

 private:
  [[nodiscard]] double* end_at(std::int64_t i) { return &ends_[static_cast<std::size_t>(i) * lanes_]; }

  /// Finds, for the block that begins at `start`, at i the largest of its samples from i on.
  void find_ends(const Line<const double>& in, std::int64_t start) {
    for (std::int64_t i = 2 * half_; i >= 0; --i) {
      double* const here = end_at(i);
      if (i == 2 * half_)
        std::fill_n(here, lanes_, kLowest);
      else
        std::copy_n(end_at(i + 1), lanes_, here);
      widen(in, start + i, here);
    }
  }

  void widen(const Line<const double>& in, std::int64_t sample, double* largest) const {
    if (sample < 0 || sample >= in.count) return;
    const double* const values = in.at(sample);
    for (std::size_t k = 0; k < lanes_; ++k) largest[k] = values[k] > largest[k] ? values[k] : largest[k];
  }

  std::int64_t half_;
  std::size_t lanes_;
  std::vector<double> ends_, begin_;
};

/// The largest of sign * value.
Grid<double> extremes(const Grid<double>& values, std::int64_t half_bins, double sign) {
  const GridSpec& spec = values.spec();
  auto along_rows = Grid<double>::unset(spec);
  auto result = Grid<double>::unset(spec);
  const std::int64_t half_cols = std::min(half_bins, spec.cols - 1);  // a wider window has no more bins
  const std::int64_t half_rows = std::min(half_bins, spec.rows - 1);
  parallel_for(static_cast<std::size_t>(spec.rows), kRowsPerStrip, [&](std::size_t begin, std::size_t end) {
    std::vector<double> signed_row(static_cast<std::size_t>(spec.cols));
    LineMaxima maxima(half_cols, 1);
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
      std::ranges::transform(values.row(row), signed_row.begin(), [&](double v) { return sign * v; });
      maxima.find({signed_row.data(), spec.cols, 1, 1}, {along_rows.row(row).data(), spec.cols, 1, 1});
    }
  });
  parallel_for(static_cast<std::size_t>(spec.cols), kColsPerPiece, [&](std::size_t begin, std::size_t end) {
    LineMaxima maxima(half_rows, end - begin);
    maxima.find({along_rows.values().data() + begin, spec.rows, spec.cols, end - begin},
                {result.values().data() + begin, spec.rows, spec.cols, end - begin});
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (double& value : result.row(row).subspan(begin, end - begin))
        value = value == kLowest ? kNan : sign * value;
  });
  return result;
}

}  // namespace

Grid<double> window_max(const Grid<double>& values, std::int64_t half_bins) {
  return extremes(values, half_bins, 1);
}

Grid<double> window_min(const Grid<double>& values, std::int64_t half_bins) {
  return extremes(values, half_bins, -1);
}

}  // namespace landfall
