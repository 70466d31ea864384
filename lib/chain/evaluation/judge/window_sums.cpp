// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/judge/window_sums.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "chain/evaluation/judge/window_sums.cpp"
#include "base/numerics/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace landfall::HWY_NAMESPACE {

/// Sums of one row of windows at a time, in buffers with room for whole vectors.
template <class T>
class SquareSums {
 public:
  using Tag = hn::CappedTag<T, kMaxLanes>;

  SquareSums(const View<const T>& values, std::int64_t half_rows, std::int64_t half_cols)
      : values_(values),
        half_rows_(half_rows),
        width_(2 * half_cols + 1),
        length_((static_cast<std::size_t>(values.cols) + kMaxLanes - 1) / kMaxLanes * kMaxLanes),
        columns_(length_),
        spans_(2 * length_),
        result_(length_) {}

  void write(const View<T>& sums) {
    for (std::int64_t row = 0; row < 2 * half_rows_; ++row) add_row(row);
    for (std::int64_t row = 0; row < sums.rows; ++row) {
      add_row(row + 2 * half_rows_);
      sum_along_row();
      std::copy_n(result_.begin(), sums.cols, sums.row(row));
      subtract_row(row);
    }
  }

 private:
  void add_row(std::int64_t row) {
    change(row, [](auto a, auto b) { return hn::Add(a, b); });
  }
  void subtract_row(std::int64_t row) {
    change(row, [](auto a, auto b) { return hn::Sub(a, b); });
  }

  template <class Change>
  HWY_INLINE void change(std::int64_t row, Change by) {
    const T* const values = values_.row(row);
    const Tag d;
    const auto cols = static_cast<std::size_t>(values_.cols);
    const std::size_t whole = cols / hn::Lanes(d) * hn::Lanes(d);
    for (std::size_t c = 0; c < whole; c += hn::Lanes(d))
      hn::StoreU(by(hn::LoadU(d, &columns_[c]), hn::LoadU(d, values + c)), d, &columns_[c]);
    for (std::size_t c = whole; c < cols; ++c) {
      const hn::CappedTag<T, 1> one;
      hn::StoreU(by(hn::LoadU(one, &columns_[c]), hn::LoadU(one, values + c)), one, &columns_[c]);
    }
  }

  /// Spans of 1, 2, 4 .. columns, and from them the span of the window: its width in binary.
  void sum_along_row() {
    const Tag d;
    std::copy(columns_.begin(), columns_.end(), spans_.begin());
    std::ranges::fill(result_, T{});
    std::int64_t summed = 0;
    for (std::int64_t power = 1;; power *= 2) {
      if ((width_ & power) != 0) {
        for (std::size_t c = 0; c < length_; c += hn::Lanes(d))
          hn::StoreU(
              hn::Add(hn::LoadU(d, &result_[c]), hn::LoadU(d, &spans_[c + static_cast<std::size_t>(summed)])),
              d, &result_[c]);
        summed += power;
      }
      if (summed == width_) return;
      for (std::size_t c = 0; c < length_; c += hn::Lanes(d))
        hn::StoreU(
            hn::Add(hn::LoadU(d, &spans_[c]), hn::LoadU(d, &spans_[c + static_cast<std::size_t>(power)])), d,
            &spans_[c]);
    }
  }

  View<const T> values_;
  std::int64_t half_rows_, width_;
  std::size_t length_;
  std::vector<T> columns_;  ///< sums of the rows of the window
  std::vector<T> spans_;    ///< zeros follow
  std::vector<T> result_;
};

/// Each row of a window as the difference of two sums from the row's beginning.
template <class T>
void SumSpans(const View<const T>& values, const Footprint& footprint, const View<T>& sums) {
  const std::int64_t half_rows = (values.rows - sums.rows) / 2;
  const std::int64_t half_cols = (values.cols - sums.cols) / 2;
  for (std::int64_t row = 0; row < sums.rows; ++row) std::fill_n(sums.row(row), sums.cols, T{});
  std::vector<T> before(static_cast<std::size_t>(values.cols) + 1);
  for (std::int64_t row = 0; row < values.rows; ++row) {
    const T* const in = values.row(row);
    for (std::size_t c = 0; c + 1 < before.size(); ++c) before[c + 1] = before[c] + in[c];
    for (std::int64_t offset = -half_rows; offset <= half_rows; ++offset) {
      const std::int64_t centre = row - half_rows - offset;
      if (centre < 0 || centre >= sums.rows) continue;
      const std::int64_t width = std::min(footprint.half_width(offset), half_cols);
      const T* const left = before.data() + half_cols - width;
      const T* const right = before.data() + half_cols + width + 1;
      T* const target = sums.row(centre);
      for (std::int64_t c = 0; c < sums.cols; ++c) target[c] += right[c] - left[c];
    }
  }
}

template <class T>
void Sum(const View<const T>& values, const Footprint& footprint, const View<T>& sums) {
  if (footprint.is_square())
    SquareSums<T>(values, (values.rows - sums.rows) / 2, (values.cols - sums.cols) / 2).write(sums);
  else
    SumSpans(values, footprint, sums);
}

void SumDoubles(const View<const double>& values, const Footprint& footprint, const View<double>& sums) {
  Sum(values, footprint, sums);
}

void SumCounts(const View<const std::uint64_t>& values, const Footprint& footprint,
               const View<std::uint64_t>& sums) {
  Sum(values, footprint, sums);
}

}  // namespace landfall::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace landfall {

HWY_EXPORT(SumDoubles);
HWY_EXPORT(SumCounts);

void window_sums(const View<const double>& values, const Footprint& footprint, const View<double>& sums) {
  HWY_DYNAMIC_DISPATCH(SumDoubles)(values, footprint, sums);
}

void window_sums(const View<const std::uint64_t>& values, const Footprint& footprint,
                 const View<std::uint64_t>& sums) {
  HWY_DYNAMIC_DISPATCH(SumCounts)(values, footprint, sums);
}

}  // namespace landfall
#endif
