// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "chain/terrain/mesh/indexed_triangles.h"

namespace landfall {

/// A box, single precision, rounded outwards.
struct TriangleBox {
  std::array<float, 3> low;
  std::array<float, 3> high;

  [[nodiscard]] bool is_over(double x, double y) const {
    return double{low[0]} <= x && x <= double{high[0]} && double{low[1]} <= y && y <= double{high[1]};
  }
  [[nodiscard]] double squared_distance(const Eigen::Vector3d& point) const {
    double total = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double at = point[static_cast<Eigen::Index>(axis)];
      const double beside = std::max({double{low[axis]} - at, at - double{high[axis]}, 0.0});
      total += beside * beside;
    }
    return total;
  }
};

/// Boxes around triangles, around pairs of boxes, and so on: a binary tree in which every leaf has the same
/// depth and at most four triangles. It does not depend on the number of threads.
class TriangleTree {
 public:
  /// The mesh must be sound. Splits the triangles at the median of their centres, along the axis on which
  /// most of them lie side by side: a split along the longest axis would keep the tall triangles of a rough
  /// surface together.
  explicit TriangleTree(const IndexedTriangles& mesh);

  /// Calls leaf(triangles) for every leaf that may matter, in ascending order of rank: rank(box) is a bound
  /// for everything within the box, and boxes are skipped once it exceeds limit(). A box of NaN or infinite
  /// rank is skipped.
  template <class Rank, class Limit, class Leaf>
  void search(const Rank& rank, const Limit& limit, const Leaf& leaf) const;

 private:
  /// A node, in heap order, and its part of order_.
  struct Branch {
    std::size_t node = 0;
    std::size_t begin = 0;
    std::size_t end = 0;
  };
  struct Builder;
  static constexpr double kNever = std::numeric_limits<double>::infinity();
  static constexpr int kDeepest = 31;  ///< exceeds what kMaxMeshElements needs

  [[nodiscard]] static std::pair<Branch, Branch> halves(const Branch& branch) {
    const std::size_t middle = branch.begin + (branch.end - branch.begin) / 2;
    return {{2 * branch.node + 1, branch.begin, middle}, {2 * branch.node + 2, middle, branch.end}};
  }

  std::vector<std::uint32_t> order_;  ///< triangles; those of a node are contiguous
  std::vector<TriangleBox> boxes_;
  std::size_t first_leaf_ = 0;
};

template <class Rank, class Limit, class Leaf>
void TriangleTree::search(const Rank& rank, const Limit& limit, const Leaf& leaf) const {
  struct Waiting {
    Branch branch;
    double rank = 0;
  };
  const auto may_matter = [&](double found) { return found <= limit() && found < kNever; };
  std::array<Waiting, kDeepest + 2> waiting;
  std::size_t count = 0;
  waiting[count++] = {{0, 0, order_.size()}, rank(boxes_.front())};
  while (count > 0) {
    const Waiting next = waiting[--count];
    if (!may_matter(next.rank)) continue;
    if (next.branch.node >= first_leaf_) {
      leaf(std::span(order_).subspan(next.branch.begin, next.branch.end - next.branch.begin));
      continue;
    }
    const std::pair<Branch, Branch> children = halves(next.branch);
    Waiting near{children.first, rank(boxes_[children.first.node])};
    Waiting far{children.second, rank(boxes_[children.second.node])};
    if (far.rank < near.rank) std::swap(near, far);
    if (may_matter(far.rank)) waiting[count++] = far;
    if (may_matter(near.rank)) waiting[count++] = near;
  }
}

}  // namespace landfall
