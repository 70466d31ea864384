// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/pixel_map.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kPointsPerPixel = 4;

/// The bins of one pixel.
struct Bins {
  std::int64_t first_row;
  std::int64_t end_row;
  std::int64_t first_col;
  std::int64_t end_col;
};

template <class T>
double mean_of(const Grid<T>& layer, const Bins& bins) {
  double sum = 0;
  std::int64_t count = 0;
  for (std::int64_t row = bins.first_row; row < bins.end_row; ++row)
    for (std::int64_t col = bins.first_col; col < bins.end_col; ++col) {
      const double value = layer.at({row, col});
      if (!std::isfinite(value)) continue;
      sum += value;
      ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : kNan;
}

template <class T>
double greatest_of(const Grid<T>& layer, const Bins& bins) {
  double greatest = kNan;
  for (std::int64_t row = bins.first_row; row < bins.end_row; ++row)
    for (std::int64_t col = bins.first_col; col < bins.end_col; ++col) {
      const double value = layer.at({row, col});
      if (std::isfinite(value) && !(value <= greatest)) greatest = value;
    }
  return greatest;
}

std::int64_t divided_up(std::int64_t a, std::int64_t b) { return (a + b - 1) / b; }

std::int64_t pixels_over(double extent_m, double pixel_m, std::int64_t most) {
  return std::clamp<std::int64_t>(std::llround(std::ceil(extent_m / pixel_m)), 1, most);
}

std::int64_t pixel_of(double distance_m, double pixel_m, std::int64_t count) {
  return std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(distance_m / pixel_m)), 0, count - 1);
}

}  // namespace

template <class T>
PixelMap reduce(const Grid<T>& layer, Reduction reduction, std::int64_t most) {
  const GridSpec& spec = layer.spec();
  const std::int64_t factor = divided_up(std::max(spec.rows, spec.cols), most);
  const double s = spec.resolution_m;
  PixelMap map{divided_up(spec.rows, factor),   divided_up(spec.cols, factor),
               static_cast<double>(factor) * s, spec.x(0) - s / 2,
               spec.y(spec.rows - 1) + s / 2,   {}};
  map.values.resize(static_cast<std::size_t>(map.rows * map.cols));
  parallel_for(static_cast<std::size_t>(map.rows), 8, [&](std::size_t begin, std::size_t end) {
    for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row)
      for (std::int64_t col = 0; col < map.cols; ++col) {
        const std::int64_t north = spec.rows - row * factor;  // bins run from the south
        const Bins bins{std::max<std::int64_t>(0, north - factor), north, col * factor,
                        std::min(spec.cols, (col + 1) * factor)};
        map.values[static_cast<std::size_t>(row * map.cols + col)] =
            reduction == Reduction::mean ? mean_of(layer, bins) : greatest_of(layer, bins);
      }
  });
  return map;
}

template PixelMap reduce(const Grid<double>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<float>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<std::int32_t>&, Reduction, std::int64_t);
template PixelMap reduce(const Grid<std::int8_t>&, Reduction, std::int64_t);

PointMap::PointMap(const Box& box, std::size_t count, std::int64_t most) {
  const double width = box.east_m - box.west_m;
  const double height = box.north_m - box.south_m;
  const double even = std::sqrt(width * height * kPointsPerPixel / static_cast<double>(count));
  const double finest = std::max(width, height) / static_cast<double>(most);
  const double pixel = std::max(even, finest);
  frame_.pixel_m = pixel > 0 && std::isfinite(pixel) ? pixel : 1;  // points on one spot
  frame_.rows = pixels_over(height, frame_.pixel_m, most);
  frame_.cols = pixels_over(width, frame_.pixel_m, most);
  frame_.west_m = box.west_m;
  frame_.north_m = box.north_m;
  sums_.resize(static_cast<std::size_t>(frame_.rows * frame_.cols));
  counts_.resize(sums_.size());
}

void PointMap::add(double x_m, double y_m, double value) {
  const std::int64_t row = pixel_of(frame_.north_m - y_m, frame_.pixel_m, frame_.rows);
  const std::int64_t col = pixel_of(x_m - frame_.west_m, frame_.pixel_m, frame_.cols);
  const auto i = static_cast<std::size_t>(row * frame_.cols + col);
  sums_[i] += value;
  ++counts_[i];
}

PixelMap PointMap::filled(std::span<const double> values) const {
  PixelMap map = frame_;
  for (std::size_t i = 0; i < counts_.size(); ++i) map.values.push_back(counts_[i] > 0 ? values[i] : kNan);
  return map;
}

PixelMap PointMap::mean() const {
  PixelMap map = filled(sums_);
  for (std::size_t i = 0; i < counts_.size(); ++i) map.values[i] /= counts_[i];
  return map;
}

PixelMap PointMap::count() const { return filled(counts_); }

}  // namespace landfall
