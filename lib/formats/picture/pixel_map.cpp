// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/picture/pixel_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/core/mapped.h"
#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

constexpr double kPointsPerPixel = 4;

std::int64_t divided_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

std::int64_t pixels_over(double extent_m, double pixel_m, std::int64_t max_pixels) {
  return std::clamp<std::int64_t>(std::llround(std::ceil(extent_m / pixel_m)), 1, max_pixels);
}

std::int64_t pixel_of(double distance_m, double pixel_m, std::int64_t count) {
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(distance_m / pixel_m)), 0, count - 1);
}

struct SurfaceSlope {
  double east = 0;
  double north = 0;
};

/// The slope from the values before and after the middle one; either may be missing.
double slope_between(double before, double middle, double after, double pixel_m) {
  const bool has_before = std::isfinite(before);
  const bool has_after = std::isfinite(after);
  if (has_before && has_after) return (after - before) / (2 * pixel_m);
  if (has_after) return (after - middle) / pixel_m;
  if (has_before) return (middle - before) / pixel_m;
  return 0;
}

SurfaceSlope slope_at(const PixelMap& map, std::int64_t row, std::int64_t col) {
  const auto value = [&](std::int64_t r, std::int64_t c) {
    const bool inside = r >= 0 && r < map.rows && c >= 0 && c < map.cols;
    return inside ? map.at(r, c) : std::numeric_limits<double>::quiet_NaN();
  };
  const double z = map.at(row, col);
  if (!std::isfinite(z)) return {};
  return {slope_between(value(row, col - 1), z, value(row, col + 1), map.pixel_m),
          slope_between(value(row + 1, col), z, value(row - 1, col), map.pixel_m)};
}

double shade_of(const SurfaceSlope& slope, double factor) {
  // Normal (-east, -north, 1) times light (-1, 1, sqrt 2) / 2, divided by its value on level terrain.
  const double east = factor * slope.east;
  const double north = factor * slope.north;
  const double shade = (east - north + std::numbers::sqrt2) / std::sqrt(1 + east * east + north * north);
  return std::max(0.0, shade / std::numbers::sqrt2);
}

}  // namespace

LayerReducer::LayerReducer(const GridSpec& layer, Reduction reduction, std::int64_t max_pixels)
    : layer_(layer),
      reduction_(reduction),
      factor_(divided_up(std::max(layer.rows, layer.cols), max_pixels)),
      frame_{divided_up(layer.rows, factor_),
             divided_up(layer.cols, factor_),
             static_cast<double>(factor_) * layer.resolution_m,
             layer.x(0) - layer.resolution_m / 2,
             layer.y(layer.rows - 1) + layer.resolution_m / 2,
             {}},
      sums_(static_cast<std::size_t>(frame_.rows * frame_.cols)),
      counts_(sums_.size()) {}

template <class T>
void LayerReducer::add_row(std::span<const T> bins, std::int64_t pixel_row) {
  for (std::size_t col = 0; col < bins.size(); ++col) {
    const double value = bins[col];
    if (!std::isfinite(value)) continue;
    const auto i =
        static_cast<std::size_t>(pixel_row * frame_.cols + static_cast<std::int64_t>(col) / factor_);
    if (reduction_ == Reduction::mean)
      sums_[i] += value;
    else if (counts_[i] == 0 || value > sums_[i])
      sums_[i] = value;
    ++counts_[i];
  }
}

template <class T>
void LayerReducer::add(const Grid<T>& rows) {
  // Pixels run from the north, bins from the south.
  const std::int64_t first = rows.spec().first_row - layer_.first_row;
  const std::int64_t end = first + rows.spec().rows;
  const std::int64_t first_pixel = (layer_.rows - end) / factor_;
  const std::int64_t last_pixel = (layer_.rows - 1 - first) / factor_;
  const auto count = static_cast<std::size_t>(last_pixel - first_pixel + 1);
  parallel_for(count, 8, [&](std::size_t begin_piece, std::size_t end_piece) {
    for (std::size_t i = begin_piece; i < end_piece; ++i) {
      const std::int64_t pixel_row = first_pixel + static_cast<std::int64_t>(i);
      const std::int64_t north = std::min(end, layer_.rows - pixel_row * factor_);
      const std::int64_t south = std::max(first, layer_.rows - (pixel_row + 1) * factor_);
      for (std::int64_t row = south; row < north; ++row) add_row(rows.row(row - first), pixel_row);
    }
  });
}

PixelMap LayerReducer::map() const {
  PixelMap map = frame_;
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    const double value = reduction_ == Reduction::mean ? sums_[i] / counts_[i] : sums_[i];
    map.values.push_back(counts_[i] > 0 ? value : kNan);
  }
  return map;
}

template <class T>
PixelMap reduce(const Grid<T>& layer, Reduction reduction, std::int64_t max_pixels) {
  LayerReducer reducer(layer.spec(), reduction, max_pixels);
  reducer.add(layer);
  return reducer.map();
}

template void LayerReducer::add(const Grid<double>&);
template void LayerReducer::add(const Grid<float>&);
template void LayerReducer::add(const Grid<std::int32_t>&);
template void LayerReducer::add(const Grid<std::int8_t>&);
template PixelMap reduce(const Grid<double>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<float>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<std::int32_t>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<std::int8_t>&, Reduction, std::int64_t);

PointMap::PointMap(const Box& box, std::size_t count, std::int64_t max_pixels, Reduction reduction)
    : reduction_(reduction) {
  const double width = box.east_m - box.west_m;
  const double height = box.north_m - box.south_m;
  const double even = std::sqrt(width * height * kPointsPerPixel / static_cast<double>(count));
  const double finest = std::max(width, height) / static_cast<double>(max_pixels);
  const double pixel = std::max(even, finest);
  frame_.pixel_m = pixel > 0 && std::isfinite(pixel) ? pixel : 1;  // all points at one place
  frame_.rows = pixels_over(height, frame_.pixel_m, max_pixels);
  frame_.cols = pixels_over(width, frame_.pixel_m, max_pixels);
  frame_.west_m = box.west_m;
  frame_.north_m = box.north_m;
  gathered_.resize(static_cast<std::size_t>(frame_.rows * frame_.cols));
  counts_.resize(gathered_.size());
}

void PointMap::add(double x_m, double y_m, double value) {
  const std::int64_t row = pixel_of(frame_.north_m - y_m, frame_.pixel_m, frame_.rows);
  const std::int64_t col = pixel_of(x_m - frame_.west_m, frame_.pixel_m, frame_.cols);
  const auto i = static_cast<std::size_t>(row * frame_.cols + col);
  if (reduction_ == Reduction::mean)
    gathered_[i] += value;
  else
    gathered_[i] = counts_[i] > 0 ? std::max(gathered_[i], value) : value;
  ++counts_[i];
}

PixelMap PointMap::filled(std::span<const double> values) const {
  PixelMap map = frame_;
  for (std::size_t i = 0; i < counts_.size(); ++i) map.values.push_back(counts_[i] > 0 ? values[i] : kNan);
  return map;
}

PixelMap PointMap::values() const {
  PixelMap map = filled(gathered_);
  if (reduction_ == Reduction::mean)
    for (std::size_t i = 0; i < counts_.size(); ++i) map.values[i] /= counts_[i];
  return map;
}

PixelMap PointMap::count() const { return filled(counts_); }

std::vector<double> hillshade(const PixelMap& elevations) {
  std::vector<SurfaceSlope> slopes;
  double squares = 0;
  double count = 0;
  for (std::int64_t row = 0; row < elevations.rows; ++row)
    for (std::int64_t col = 0; col < elevations.cols; ++col) {
      slopes.push_back(slope_at(elevations, row, col));
      squares += slopes.back().east * slopes.back().east + slopes.back().north * slopes.back().north;
      count += std::isfinite(elevations.at(row, col)) ? 1 : 0;
    }
  const double rms = count > 0 ? std::sqrt(squares / count) : 0;
  const double factor = rms > 0 ? std::clamp(0.4 / rms, 0.25, 5.0) : 1;
  return mapped(slopes, [factor](const SurfaceSlope& slope) { return shade_of(slope, factor); });
}

}  // namespace landfall
