// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/convex_hull.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/convex_hull_2.h>

#include <iterator>

namespace landfall {

std::vector<Horizontal> convex_hull(const std::vector<Horizontal>& points) {
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_2;
  std::vector<Point> all;
  all.reserve(points.size());
  for (const Horizontal& point : points) all.emplace_back(point.x, point.y);
  std::vector<Point> corners;
  CGAL::convex_hull_2(all.begin(), all.end(), std::back_inserter(corners));
  std::vector<Horizontal> hull;
  for (const Point& corner : corners) hull.push_back({corner.x(), corner.y()});
  return hull;
}

}  // namespace landfall
