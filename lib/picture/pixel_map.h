// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "raster/grid.h"

namespace landfall {

/// A map as it is drawn: square pixels, row 0 the northern.
struct PixelMap {
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  double pixel_m = 0;          ///< edge of a pixel
  double west_m = 0;           ///< western edge of column 0
  double north_m = 0;          ///< northern edge of row 0
  std::vector<double> values;  ///< row by row; NaN is no value

  [[nodiscard]] double at(std::int64_t row, std::int64_t col) const {
    return values[static_cast<std::size_t>(row * cols + col)];
  }
};

/// What stands for the bins of one pixel.
enum class Reduction {
  mean,      ///< of those that have a value
  greatest,  ///< so that no flag is lost
};

/// Makes a map of a layer that comes in strips.
class LayerReducer {
 public:
  /// At most `most` pixels a side (>= 1): each covers the same square number of bins of the layer, those at
  /// its southern and eastern border perhaps fewer.
  LayerReducer(const GridSpec& layer, Reduction reduction, std::int64_t most);

  /// Adds whole rows of the layer, in any order, each once. T: double, float, std::int32_t or std::int8_t.
  template <class T>
  void add(const Grid<T>& rows);
  [[nodiscard]] PixelMap map() const;

 private:
  template <class T>
  void add_row(std::span<const T> bins, std::int64_t pixel_row);

  GridSpec layer_;
  Reduction reduction_;
  std::int64_t factor_;
  PixelMap frame_;            ///< without values
  std::vector<double> sums_;  ///< or the greatest so far
  std::vector<double> counts_;
};

/// A layer that is there as a whole.
template <class T>
[[nodiscard]] PixelMap reduce(const Grid<T>& layer, Reduction reduction, std::int64_t most);

/// Gathers points seen from above: the mean of their values per pixel, or their count.
class PointMap {
 public:
  /// Points lie within the box; pixels are so large that a pixel has about four of `count` evenly spread
  /// points, and at most `most` pixels a side.
  struct Box {
    double west_m;
    double east_m;
    double south_m;
    double north_m;
  };
  PointMap(const Box& box, std::size_t count, std::int64_t most, Reduction reduction = Reduction::mean);

  /// A point outside the box counts in the nearest pixel.
  void add(double x_m, double y_m, double value);
  /// The mean or the greatest value of each pixel's points; NaN without any.
  [[nodiscard]] PixelMap values() const;
  [[nodiscard]] PixelMap count() const;

 private:
  [[nodiscard]] PixelMap filled(std::span<const double> values) const;

  PixelMap frame_;  ///< without values
  Reduction reduction_;
  std::vector<double> gathered_;  ///< sums, or the greatest so far
  std::vector<double> counts_;
};

}  // namespace landfall
