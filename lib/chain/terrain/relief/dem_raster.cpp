// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D16, D17, D433
#include "chain/terrain/relief/dem_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "base/core/error.h"

namespace landfall {
namespace {

/// Pixels within which a position is on the border or on a pixel's centre: georeferences carry no more than 9
/// to 12 digits.
constexpr double kTolerance_px = 1e-6;

/// How far beyond the first and the last pixel centre a method reaches.
double overhang(Interpolation method) { return method == Interpolation::nearest ? 0.5 : 0; }

/// The samples that one axis uses, first, first + 1, .., and their weights.
template <std::size_t N>
struct Taps {
  std::int64_t first = 0;
  std::array<double, N> weight{};
};

/// The cell of a coordinate and the fraction within it, which is 0 or 1 on a pixel's centre, so that no other
/// sample has a weight there. The last centre belongs to the last cell.
struct Cell {
  std::int64_t index;
  double fraction;
};

Cell cell_of(double coordinate, std::int64_t count) {
  const double clamped = std::clamp(coordinate, 0.0, static_cast<double>(count - 1));
  const auto index = std::min(static_cast<std::int64_t>(clamped), std::max<std::int64_t>(count - 2, 0));
  const double fraction = clamped - static_cast<double>(index);
  if (fraction <= kTolerance_px) return {index, 0};
  return {index, fraction >= 1 - kTolerance_px ? 1 : fraction};
}

Taps<1> nearest_taps(double coordinate, std::int64_t count) {
  const auto index = static_cast<std::int64_t>(std::floor(coordinate + 0.5));
  return {std::clamp<std::int64_t>(index, 0, count - 1), {1.0}};
}

Taps<2> linear_taps(double coordinate, std::int64_t count) {
  const auto [index, t] = cell_of(coordinate, count);
  return {index, {1 - t, t}};
}

/// Keys (1981), eq. 4, a = -1/2.
Taps<4> cubic_taps(double coordinate, std::int64_t count) {
  const auto [index, t] = cell_of(coordinate, count);
  const double t2 = t * t;
  const double t3 = t2 * t;
  return {index - 1,
          {(-t3 + 2 * t2 - t) / 2, (3 * t3 - 5 * t2 + 2) / 2, (-3 * t3 + 4 * t2 + t) / 2, (t3 - t2) / 2}};
}

/// The weighted sum, with indices beyond the border clamped to it. Samples of zero weight are ignored.
template <std::size_t N>
double weighted(const DemSamples& samples, const Taps<N>& rows, const Taps<N>& cols) {
  double sum = 0;
  for (std::size_t i = 0; i < N; ++i) {
    if (rows.weight[i] == 0) continue;
    const auto row =
        std::clamp<std::int64_t>(rows.first + static_cast<std::int64_t>(i), 0, samples.size.rows - 1);
    double line = 0;
    for (std::size_t j = 0; j < N; ++j) {
      if (cols.weight[j] == 0) continue;
      const auto col =
          std::clamp<std::int64_t>(cols.first + static_cast<std::int64_t>(j), 0, samples.size.cols - 1);
      line += cols.weight[j] * samples.at(row, col);
    }
    sum += rows.weight[i] * line;
  }
  return sum;
}

bool within(double low, double high, std::int64_t count, double reach) {
  return low >= -reach && high <= static_cast<double>(count - 1) + reach;
}

void extend(PixelBox& box, const PixelPosition& p) {
  // The comparisons are negated so that a NaN enters the box.
  if (!(p.col >= box.low.col)) box.low.col = p.col;
  if (!(p.row >= box.low.row)) box.low.row = p.row;
  if (!(p.col <= box.high.col)) box.high.col = p.col;
  if (!(p.row <= box.high.row)) box.high.row = p.row;
}

}  // namespace

double interpolate(const DemSamples& samples, Interpolation method, const PixelPosition& pixel) {
  if (!inside(samples.size, method, pixel)) return std::numeric_limits<double>::quiet_NaN();
  const auto [rows, cols] = samples.size;
  if (method == Interpolation::nearest)
    return weighted(samples, nearest_taps(pixel.row, rows), nearest_taps(pixel.col, cols));
  if (method == Interpolation::bicubic) {
    const double z = weighted(samples, cubic_taps(pixel.row, rows), cubic_taps(pixel.col, cols));
    if (std::isfinite(z)) return z;
  }
  return weighted(samples, linear_taps(pixel.row, rows), linear_taps(pixel.col, cols));
}

bool box_inside(const RasterSize& size, Interpolation method, const PixelBox& box) {
  const double reach = overhang(method) + kTolerance_px;
  return within(box.low.col, box.high.col, size.cols, reach) &&
         within(box.low.row, box.high.row, size.rows, reach);
}

bool inside(const RasterSize& size, Interpolation method, const PixelPosition& pixel) {
  return box_inside(size, method, {pixel, pixel});
}

PixelBox pixel_box(const SiteMapping& mapping, const GridSpec& site) {
  // On a border with very many nodes, some 4096 points, always including the corners, bound the box well
  // enough to choose a window; every node is checked again when it is interpolated.
  const auto visit = [](std::int64_t count, const auto& at) {
    const std::int64_t step = std::max<std::int64_t>(1, count / 4096);
    for (std::int64_t i = 0; i < count; i += step) at(i);
    at(count - 1);
  };
  const PixelPosition corner = mapping.pixel({site.x(0), site.y(0)});
  PixelBox box{corner, corner};
  for (const std::int64_t row : {std::int64_t{0}, site.rows - 1})
    visit(site.cols, [&](std::int64_t col) { extend(box, mapping.pixel({site.x(col), site.y(row)})); });
  for (const std::int64_t col : {std::int64_t{0}, site.cols - 1})
    visit(site.rows, [&](std::int64_t row) { extend(box, mapping.pixel({site.x(col), site.y(row)})); });
  // Around a pole the nodes have every longitude, and latitudes beyond those of the border.
  const std::optional<SitePoint> pole = mapping.pole();
  const auto within = [](double value, double low, double high) { return value >= low && value <= high; };
  if (pole && within(pole->x_m, site.x(0), site.x(site.cols - 1)) &&
      within(pole->y_m, site.y(0), site.y(site.rows - 1))) {
    const double middle = mapping.pixel({0, 0}).col;
    const double row = mapping.pixel(*pole).row;
    extend(box, {middle - mapping.half_turn_px(), row});
    extend(box, {middle + mapping.half_turn_px(), row});
  }
  return box;
}

std::int64_t largest_half(const SiteMapping& mapping, const RasterSize& size, Interpolation method,
                          double resolution_m, std::int64_t limit) {
  std::int64_t fits = -1;
  std::int64_t fails = limit + 1;
  while (fails - fits > 1) {
    const std::int64_t half = fits + (fails - fits) / 2;
    const GridSpec square{resolution_m, -half, -half, 2 * half + 1, 2 * half + 1};
    (box_inside(size, method, pixel_box(mapping, square)) ? fits : fails) = half;
  }
  return fits;
}

void require_site_inside(const SiteMapping& mapping, const RasterSize& size, Interpolation method,
                         const GridSpec& site, const std::string& what) {
  if (box_inside(size, method, pixel_box(mapping, site))) return;
  std::ostringstream message;
  message.precision(10);
  message << what << ": the site, " << site.x(0) << " .. " << site.x(site.cols - 1)
          << " m, does not lie inside the raster of " << size.cols << " x " << size.rows << " pixels; ";
  const std::int64_t half =
      largest_half(mapping, size, method, site.resolution_m, std::max(site.rows, site.cols));
  if (half < 0) {
    message << "its centre is outside too: give another center";
  } else if (half == 0) {
    message << "not one cell of " << site.resolution_m
            << " m fits around this centre: give another center or a finer resolution";
  } else {
    message << "around this centre a half_width_m of " << static_cast<double>(half) * site.resolution_m
            << " would fit";
    throw FormatError(message.str(), "half_width_m");
  }
  throw FormatError(message.str());
}

}  // namespace landfall
