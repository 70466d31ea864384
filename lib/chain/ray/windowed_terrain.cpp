// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D123
//
// The window of a large terrain is verified for each ray: the points where a ray enters the band between
// the terrain's lowest and highest elevation, and where it hits or leaves it, must be in the window, and
// so must its start if it is not above the band. If not, the window grows and the bundle is traced again;
// because results do not depend on the window, nothing else is repeated.
//
// `actual_range` (CF) of `z` gives these elevations; for a file without it, all tiles are read once. A
// window that contains a value outside this range is refused.
#include "chain/ray/windowed_terrain.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/non_finite.h"

namespace landfall {
namespace {

constexpr TerrainBox kEverywhere{-kInfinity, kInfinity, -kInfinity, kInfinity};

/// The range, in metres, in which nodes [begin, end) of an axis with `count` nodes certainly decide.
std::pair<double, double> certain_range(std::int64_t begin, std::int64_t end, std::int64_t count,
                                        std::int64_t first_node, double resolution_m) {
  const double low = static_cast<double>(first_node + begin + 1) * resolution_m;
  const double high = static_cast<double>(first_node + end - 2) * resolution_m;
  return {begin == 0 ? -kInfinity : low, end == count ? kInfinity : high};
}

/// The nodes [begin, end) around [low, high] metres, widened to whole tiles.
std::pair<std::int64_t, std::int64_t> tiles_around(double low, double high, std::int64_t count,
                                                   std::int64_t first_node, double resolution_m,
                                                   std::int64_t tile) {
  const auto node = [&](double point) {
    const double number = std::floor(point / resolution_m) - static_cast<double>(first_node);
    return static_cast<std::int64_t>(std::clamp(number, 0.0, static_cast<double>(count - 1)));
  };
  const std::int64_t begin = std::max<std::int64_t>(node(low) - 2, 0) / tile * tile;
  const std::int64_t end = (std::min(node(high) + 4, count) + tile - 1) / tile * tile;
  // A last tile of a single node holds no cell.
  const std::int64_t last = end + 1 >= count ? count : end;
  return {count - begin < 2 ? std::max<std::int64_t>(begin - tile, 0) : begin, std::min(last, count)};
}

}  // namespace

void TerrainBox::add(double x_m, double y_m) { add({x_m, x_m, y_m, y_m}); }

void TerrainBox::add(const TerrainBox& box) {
  low_x = std::min(low_x, box.low_x);
  high_x = std::max(high_x, box.high_x);
  low_y = std::min(low_y, box.low_y);
  high_y = std::max(high_y, box.high_y);
}

bool TerrainBox::contains(const TerrainBox& box) const {
  return box.empty() ||
         (box.low_x >= low_x && box.high_x <= high_x && box.low_y >= low_y && box.high_y <= high_y);
}

struct WindowedTerrain::Window {
  GridSpec spec;
  TerrainBox certain;
  std::shared_ptr<const TriangulatedGrid> surface;
  std::unique_ptr<const RayEngine> engine;
};

WindowedTerrain::WindowedTerrain(LargeTerrain terrain, EngineMaker make_engine)
    : terrain_(std::move(terrain)),
      make_engine_(std::move(make_engine)),
      origin_(CellOrigin::of_windows(terrain_.spec,
                                     std::max(std::abs(terrain_.lowest_m), std::abs(terrain_.highest_m)))) {
  if (!CellOrigin::has_windows(terrain_.spec))
    throw UsageError("a terrain that reaches 2^15 nodes from its centre cannot be loaded in part");
}

std::shared_ptr<const WindowedTerrain::Window> WindowedTerrain::current() const {
  const std::shared_lock lock(reading_);
  return window_;
}

GridSpec WindowedTerrain::window() const {
  const auto window = current();
  return window ? window->spec : GridSpec{terrain_.spec.resolution_m};
}

std::shared_ptr<const WindowedTerrain::Window> WindowedTerrain::load(const GridSpec& spec) const {
  auto window = std::make_shared<Window>();
  window->spec = spec;
  const GridSpec& whole = terrain_.spec;
  const std::int64_t col = spec.first_col - whole.first_col;
  const std::int64_t row = spec.first_row - whole.first_row;
  const auto x = certain_range(col, col + spec.cols, whole.cols, whole.first_col, whole.resolution_m);
  const auto y = certain_range(row, row + spec.rows, whole.rows, whole.first_row, whole.resolution_m);
  window->certain = {x.first, x.second, y.first, y.second};
  run_isolated([&] {
    window->surface = std::make_shared<const TriangulatedGrid>(terrain_.load(spec), origin_);
    if (make_engine_) window->engine = make_engine_(window->surface);
  });
  return window;
}

GridSpec WindowedTerrain::nodes_around(TerrainBox box) const {
  const GridSpec& whole = terrain_.spec;
  const double s = whole.resolution_m;
  const TerrainBox all{whole.x(0), whole.x(whole.cols - 1), whole.y(0), whole.y(whole.rows - 1)};
  box = {std::clamp(box.low_x, all.low_x, all.high_x), std::clamp(box.high_x, all.low_x, all.high_x),
         std::clamp(box.low_y, all.low_y, all.high_y), std::clamp(box.high_y, all.low_y, all.high_y)};
  // A margin for later requests, so that windows are loaded less often.
  const double room_m = std::max((box.high_x - box.low_x + box.high_y - box.low_y) / 8, 8 * s);
  const auto cols = tiles_around(box.low_x - room_m, box.high_x + room_m, whole.cols, whole.first_col, s,
                                 terrain_.tile.col);
  const auto rows = tiles_around(box.low_y - room_m, box.high_y + room_m, whole.rows, whole.first_row, s,
                                 terrain_.tile.row);
  return {s, whole.first_row + rows.first, whole.first_col + cols.first, rows.second - rows.first,
          cols.second - cols.first};
}

std::shared_ptr<const WindowedTerrain::Window> WindowedTerrain::holding(const TerrainBox& needed) const {
  const std::lock_guard lock(growing_);
  std::shared_ptr<const Window> window = current();
  if (window && window->certain.contains(needed)) return window;
  TerrainBox box = needed;
  if (window) {
    box.add(window->spec.x(0), window->spec.y(0));
    box.add(window->spec.x(window->spec.cols - 1), window->spec.y(window->spec.rows - 1));
  }
  window = load(nodes_around(box));
  const std::lock_guard write_lock(reading_);
  window_ = window;
  return window;
}

void WindowedTerrain::require(const TerrainBox& box) const {
  if (!box.empty()) static_cast<void>(holding(box));
}

TerrainBox WindowedTerrain::needed_by(const Ray& ray, double range_m) const {
  const Eigen::Vector3d& o = ray.origin.v;
  const Eigen::Vector3d& d = ray.direction.v;
  if (!o.allFinite() || !d.allFinite()) return {};
  const double slack_m = 1e-6 * (1 + origin_.highest_abs_m());
  const double high_m = terrain_.highest_m + slack_m;
  const double low_m = terrain_.lowest_m - slack_m;
  if (o.z() > high_m && d.z() >= 0) return {};
  // Farther out, CellOrigin does not keep answers independent of the window.
  constexpr double kFarthest_cells = 0x1p15;
  const double farthest_m = kFarthest_cells * terrain_.spec.resolution_m;
  if (std::abs(o.x()) >= farthest_m || std::abs(o.y()) >= farthest_m) return kEverywhere;
  const double enters_m = o.z() > high_m ? (high_m - o.z()) / d.z() : 0;
  const double leaves_m = d.z() < 0 ? (low_m - o.z()) / d.z() : (high_m - o.z()) / d.z();
  const double ends_m = std::isnan(range_m) ? std::max(enters_m, leaves_m) : range_m;
  if (!std::isfinite(ends_m)) return kEverywhere;
  TerrainBox box;
  for (const double t : {enters_m, ends_m}) box.add(o.x() + t * d.x(), o.y() + t * d.y());
  return box;
}

void WindowedTerrain::first_hits(std::span<const Ray> rays, std::span<double> ranges) const {
  std::fill(ranges.begin(), ranges.end(), std::numeric_limits<double>::quiet_NaN());
  for (std::shared_ptr<const Window> window = current();;) {
    if (window) window->engine->first_hits(rays, ranges);
    TerrainBox needed;
    for (std::size_t i = 0; i < rays.size(); ++i) needed.add(needed_by(rays[i], ranges[i]));
    if (needed.empty() || (window && window->certain.contains(needed))) return;
    window = holding(needed);
  }
}

bool WindowedTerrain::off_terrain(double x_m, double y_m) const {
  const GridSpec& spec = terrain_.spec;
  const double s = spec.resolution_m;
  return !(x_m >= spec.x(0) - s && x_m <= spec.x(spec.cols - 1) + s && y_m >= spec.y(0) - s &&
           y_m <= spec.y(spec.rows - 1) + s);
}

double WindowedTerrain::elevation(double x_m, double y_m) const {
  if (off_terrain(x_m, y_m)) return std::numeric_limits<double>::quiet_NaN();
  const TerrainBox box{x_m, x_m, y_m, y_m};
  auto window = current();
  if (!window || !window->certain.contains(box)) window = holding(box);
  return window->surface->elevation(x_m, y_m);
}

Eigen::Vector3d WindowedTerrain::normal(const Eigen::Vector3d& point) const {
  if (off_terrain(point.x(), point.y()))
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  const TerrainBox box{point.x(), point.x(), point.y(), point.y()};
  auto window = current();
  if (!window || !window->certain.contains(box)) window = holding(box);
  return window->surface->normal(point);
}

void WindowedTerrain::cosines(std::span<const Eigen::Vector3d> points,
                              std::span<const Eigen::Vector3d> directions, std::span<double> out) const {
  TerrainBox box;
  for (const Eigen::Vector3d& point : points) {
    if (off_terrain(point.x(), point.y())) return TerrainSurface::cosines(points, directions, out);
    box.add(point.x(), point.y());
  }
  if (points.empty()) return;
  auto window = current();
  if (!window || !window->certain.contains(box)) window = holding(box);
  window->surface->cosines(points, directions, out);
}

}  // namespace landfall
