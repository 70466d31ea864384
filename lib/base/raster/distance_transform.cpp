// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/distance_transform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kColumnsPerPiece = 64;
constexpr std::size_t kDistanceRows = 16;

/// Exceeds any distance in the grid: the value of a column without a set bin.
std::int64_t beyond(const GridSpec& spec) { return spec.rows + spec.cols; }

struct ColumnRange {
  std::int64_t begin;
  std::int64_t end;
};

/// The distance along the column to its nearest set bin, for a range of columns.
void scan_columns(const BinMask& set, ColumnRange columns, Grid<std::int64_t>& distance) {
  const GridSpec& spec = set.spec();
  const std::int64_t far = beyond(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = columns.begin; col < columns.end; ++col) {
      const std::int64_t below = row > 0 ? distance.at({row - 1, col}) : far;
      distance.at({row, col}) = set.at({row, col}) != 0 ? 0 : std::min(below + 1, far);
    }
  }
  for (std::int64_t row = spec.rows - 2; row >= 0; --row) {
    for (std::int64_t col = columns.begin; col < columns.end; ++col) {
      std::int64_t& d = distance.at({row, col});
      d = std::min(d, distance.at({row + 1, col}) + 1);
    }
  }
}

/// The lower envelope of the parabolas (x - i)^2 + g(i)^2 of one row, by increasing x. Its buffers are reused
/// for every row.
class RowEnvelope {
 public:
  /// Replaces the column distances of a row by squared distances.
  void transform(std::span<std::int64_t> row) {
    column_distance_.assign(row.begin(), row.end());
    build();
    std::size_t piece = pieces_.size() - 1;
    for (std::int64_t x = std::ssize(row) - 1; x >= 0; --x) {
      row[static_cast<std::size_t>(x)] = parabola(x, pieces_[piece].apex);
      if (x == pieces_[piece].begin && piece > 0) --piece;
    }
  }

 private:
  struct Piece {
    std::int64_t apex;
    std::int64_t begin;  ///< the first x at which this parabola is the lowest
  };

  [[nodiscard]] std::int64_t g(std::int64_t i) const { return column_distance_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] std::int64_t parabola(std::int64_t x, std::int64_t apex) const {
    return (x - apex) * (x - apex) + g(apex) * g(apex);
  }
  /// The last x at which the parabola of i is not above the parabola of u > i.
  [[nodiscard]] std::int64_t last_not_above(std::int64_t i, std::int64_t u) const {
    return (u * u - i * i + g(u) * g(u) - g(i) * g(i)) / (2 * (u - i));
  }

  void build() {
    pieces_.assign(1, {0, 0});
    for (std::int64_t u = 1; u < std::ssize(column_distance_); ++u) {
      while (!pieces_.empty() &&
             parabola(pieces_.back().begin, pieces_.back().apex) > parabola(pieces_.back().begin, u))
        pieces_.pop_back();
      // After the loop the numerator of last_not_above is not negative, so the division rounds down.
      const std::int64_t begin = pieces_.empty() ? 0 : last_not_above(pieces_.back().apex, u) + 1;
      if (begin < std::ssize(column_distance_)) pieces_.push_back({u, begin});
    }
  }

  std::vector<std::int64_t> column_distance_;
  std::vector<Piece> pieces_;
};

}  // namespace

Grid<std::int64_t> squared_distance(const BinMask& set) {
  const GridSpec& spec = set.spec();
  auto distance = Grid<std::int64_t>::unset(spec);
  if (spec.size() == 0) return distance;
  parallel_for(
      static_cast<std::size_t>(spec.cols), kColumnsPerPiece, [&](std::size_t begin, std::size_t end) {
        scan_columns(set, {static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)}, distance);
      });
  const std::int64_t far = beyond(spec);
  parallel_for(static_cast<std::size_t>(spec.rows), kDistanceRows, [&](std::size_t begin, std::size_t end) {
    RowEnvelope envelope;
    for (std::size_t row = begin; row < end; ++row) {
      const std::span<std::int64_t> values = distance.row(static_cast<std::int64_t>(row));
      envelope.transform(values);
      for (std::int64_t& d : values)
        if (d >= far * far) d = kNoValidBin;
    }
  });
  return distance;
}

double bins_apart(std::int64_t squared) {
  return squared == kNoValidBin ? std::numeric_limits<double>::infinity()
                                : std::sqrt(static_cast<double>(squared));
}

}  // namespace landfall
