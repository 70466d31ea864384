// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/raster/grid.h"

namespace landfall {

/// A map as drawn: square pixels, row 0 is the northern row.
struct PixelMap {
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  double pixel_m = 0;          ///< edge of a pixel
  double west_m = 0;           ///< western edge of column 0
  double north_m = 0;          ///< northern edge of row 0
  std::vector<double> values;  ///< row by row; NaN for no value

  [[nodiscard]] double at(std::int64_t row, std::int64_t col) const {
    return values[static_cast<std::size_t>(row * cols + col)];
  }
};

/// How the values of a pixel's bins are combined.
enum class Reduction {
  mean,      ///< of those that have a value
  greatest,  ///< so that no flag is lost
};

/// Reduces a layer that is passed in strips to a map.
class LayerReducer {
 public:
  /// At most `max_pixels` pixels a side (>= 1). Each pixel covers a square of equally many bins of the layer;
  /// pixels at the southern and eastern border may cover fewer.
  LayerReducer(const GridSpec& layer, Reduction reduction, std::int64_t max_pixels);

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
  PixelMap frame_;            ///< has no values
  std::vector<double> sums_;  ///< or the greatest values so far
  std::vector<double> counts_;
};

/// Reduces a layer that is in memory as a whole.
template <class T>
[[nodiscard]] PixelMap reduce(const Grid<T>& layer, Reduction reduction, std::int64_t max_pixels);

/// Maps points seen from above: per pixel, the mean of their values or their count.
class PointMap {
 public:
  /// The box that contains the points. Pixels are large enough to hold about four of `count` evenly spread
  /// points each, with at most `max_pixels` pixels a side.
  struct Box {
    double west_m;
    double east_m;
    double south_m;
    double north_m;
  };
  PointMap(const Box& box, std::size_t count, std::int64_t max_pixels, Reduction reduction = Reduction::mean);

  /// A point outside the box is added to the nearest pixel.
  void add(double x_m, double y_m, double value);
  /// The mean or the greatest value of each pixel's points; NaN without any.
  [[nodiscard]] PixelMap values() const;
  [[nodiscard]] PixelMap count() const;

 private:
  [[nodiscard]] PixelMap filled(std::span<const double> values) const;

  PixelMap frame_;  ///< has no values
  Reduction reduction_;
  std::vector<double> gathered_;  ///< sums, or the greatest values so far
  std::vector<double> counts_;
};

/// The shade of each pixel of an elevation map (metres) under light from the north-west, 45 degrees high: 1
/// for level terrain, 0 for slopes facing away. Slopes come from the neighbours: a side without a value is
/// ignored, and a pixel without any neighbour is level. Heights are scaled by one factor in [1/4, 5] that
/// brings the rms slope nearest to 0.4.
[[nodiscard]] std::vector<double> hillshade(const PixelMap& elevations);

}  // namespace landfall
