// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D394
#include "base/raster/polygon.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"
#include "base/numerics/portable_math.h"
#include "base/raster/by_rows.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kBorder_m = 1e-9;
constexpr double kFarthest_m = 1e9;

struct Edge {
  Horizontal a, b;
};

std::vector<Edge> edges_of(const Polygon& polygon) {
  std::vector<Edge> edges;
  for (const Polygon::Ring& ring : polygon.rings())
    for (std::size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
  return edges;
}

double distance_to(const Edge& edge, Horizontal place) {
  const double dx = edge.b.x - edge.a.x;
  const double dy = edge.b.y - edge.a.y;
  const double squared = dx * dx + dy * dy;
  const double along = squared > 0 ? ((place.x - edge.a.x) * dx + (place.y - edge.a.y) * dy) / squared : 0;
  const double t = std::clamp(along, 0.0, 1.0);
  return portable::hypot(place.x - (edge.a.x + t * dx), place.y - (edge.a.y + t * dy));
}

/// Whether the ray from the place along +x crosses the edge.
bool is_crossed(const Edge& edge, Horizontal place) {
  const auto& [a, b] = edge;
  if ((a.y > place.y) == (b.y > place.y)) return false;
  return place.x < a.x + (b.x - a.x) * (place.y - a.y) / (b.y - a.y);
}

bool is_inside(const std::vector<Edge>& edges, Horizontal place) {
  bool inside = false;
  for (const Edge& edge : edges) {
    if (distance_to(edge, place) <= kBorder_m) return true;
    if (is_crossed(edge, place)) inside = !inside;
  }
  return inside;
}

/// The edges that decide about the places with this y.
std::vector<Edge> edges_at(const std::vector<Edge>& edges, double y) {
  std::vector<Edge> found;
  std::ranges::copy_if(edges, std::back_inserter(found), [&](const Edge& edge) {
    return std::min(edge.a.y, edge.b.y) <= y + 2 * kBorder_m &&
           std::max(edge.a.y, edge.b.y) >= y - 2 * kBorder_m;
  });
  return found;
}

void add_bins(const Polygon& polygon, BinMask& mask) {
  const GridSpec& dem = mask.spec();
  const std::vector<Edge> edges = edges_of(polygon);
  by_rows(dem, [&](std::int64_t row) {
    const std::vector<Edge> near = edges_at(edges, dem.y(row));
    if (near.empty()) return;
    const auto bins = mask.row(row);
    for (std::size_t col = 0; col < bins.size(); ++col)
      if (is_inside(near, {dem.x(static_cast<std::int64_t>(col)), dem.y(row)})) bins[col] = 1;
  });
}

/// The signed distance of a place from the line through the edge.
double side_of(const Edge& edge, Horizontal place) {
  const double dx = edge.b.x - edge.a.x;
  const double dy = edge.b.y - edge.a.y;
  const double length = portable::hypot(dx, dy);
  return length > 0 ? (dx * (place.y - edge.a.y) - dy * (place.x - edge.a.x)) / length : 0;
}

bool lie_on_both_sides(const Edge& edge, const Edge& other) {
  const double a = side_of(edge, other.a);
  const double b = side_of(edge, other.b);
  return std::min(a, b) < -kBorder_m && std::max(a, b) > kBorder_m;
}

bool cross(const Edge& one, const Edge& other) {
  return std::max(one.a.x, one.b.x) >= std::min(other.a.x, other.b.x) &&
         std::max(other.a.x, other.b.x) >= std::min(one.a.x, one.b.x) && lie_on_both_sides(one, other) &&
         lie_on_both_sides(other, one);
}

std::string place_text(Horizontal place) {
  return "(" + short_number(place.x) + ", " + short_number(place.y) + ") m";
}

void require_no_crossing(std::vector<Edge> edges, const std::string& what) {
  const auto low = [](const Edge& edge) { return std::min(edge.a.y, edge.b.y); };
  std::ranges::sort(edges, {}, low);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t k = i + 1; k < edges.size() && low(edges[k]) <= std::max(edges[i].a.y, edges[i].b.y);
         ++k)
      if (cross(edges[i], edges[k]))
        throw UsageError(what + ": the polygon crosses itself: the edge from " + place_text(edges[i].a) +
                         " to " + place_text(edges[i].b) + " and that from " + place_text(edges[k].a) +
                         " to " + place_text(edges[k].b));
}

double doubled_area(const Polygon::Ring& ring) {
  double sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Horizontal a = ring[i];
    const Horizontal b = ring[(i + 1) % ring.size()];
    sum += (a.x - ring[0].x) * (b.y - ring[0].y) - (b.x - ring[0].x) * (a.y - ring[0].y);
  }
  return sum;
}

struct PolygonBox {
  double low_x, high_x, low_y, high_y;
};

PolygonBox box_of(const std::vector<Polygon>& polygons) {
  PolygonBox box{kInfinity, -kInfinity, kInfinity, -kInfinity};
  for (const Polygon& polygon : polygons)
    for (const Polygon::Ring& ring : polygon.rings())
      for (const Horizontal& vertex : ring)
        box = {std::min(box.low_x, vertex.x), std::max(box.high_x, vertex.x), std::min(box.low_y, vertex.y),
               std::max(box.high_y, vertex.y)};
  return box;
}

/// The outer edges of the bins.
PolygonBox box_of(const GridSpec& dem) {
  const double half_m = dem.resolution_m / 2;
  return {dem.x(0) - half_m, dem.x(dem.cols - 1) + half_m, dem.y(0) - half_m, dem.y(dem.rows - 1) + half_m};
}

std::string text_of(const PolygonBox& box) {
  return "x " + short_number(box.low_x) + " to " + short_number(box.high_x) + " and y " +
         short_number(box.low_y) + " to " + short_number(box.high_y) + " m";
}

}  // namespace

bool Polygon::contains(Horizontal place) const { return is_inside(edges_of(*this), place); }

void require_simple(const Polygon& polygon, const std::string& what) {
  const auto is_unknown = [](const Horizontal& v) { return !std::isfinite(v.x) || !std::isfinite(v.y); };
  for (const Polygon::Ring& ring : polygon.rings())
    if (std::ranges::any_of(ring, is_unknown))
      throw UsageError(what + ": a coordinate of the polygon is not a finite number");
  for (const Polygon::Ring& ring : polygon.rings())
    for (const Horizontal& v : ring)
      if (std::max(std::abs(v.x), std::abs(v.y)) > kFarthest_m)
        throw UsageError(what + ": the polygon has a vertex at " + short_number(v.x) + ", " +
                         short_number(v.y) + " m, farther out than the 1e9 m of a frame");
  require_no_crossing(edges_of(polygon), what);
  for (const Polygon::Ring& ring : polygon.rings())
    if (ring.size() < 3 || !(std::abs(doubled_area(ring)) > kBorder_m))
      throw UsageError(what + ": the polygon is empty: a ring of " + std::to_string(ring.size()) +
                       " vertices without area");
}

BinMask clipped_polygons(const GridSpec& dem, const std::vector<Polygon>& polygons) {
  BinMask mask(dem);
  for (const Polygon& polygon : polygons) add_bins(polygon, mask);
  return mask;
}

BinMask polygon_region(const GridSpec& dem, const std::vector<Polygon>& polygons, const std::string& what) {
  const PolygonBox box = box_of(polygons);
  const PolygonBox map = box_of(dem);
  if (box.low_x < map.low_x || box.high_x > map.high_x || box.low_y < map.low_y || box.high_y > map.high_y)
    throw UsageError(what + ": the polygon reaches beyond the map: " + text_of(box) + "; the map covers " +
                     text_of(map));
  BinMask mask = clipped_polygons(dem, polygons);
  if (count_set(mask) == 0) throw UsageError(what + ": no centre of a bin lies in the polygon");
  return mask;
}

}  // namespace landfall
