// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/mesh/triangle_tree.h"

#include <cmath>
#include <numeric>

#include "base/core/parallel.h"
#include "base/numerics/rounding.h"

namespace landfall {
namespace {

constexpr std::size_t kLeafSize = 4;
constexpr std::size_t kWorthAThread = 1U << 14U;
constexpr std::size_t kGrain = 1U << 12U;

TriangleBox box_around(const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d low = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Eigen::Vector3d high = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  TriangleBox box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    box.low[axis] = rounded_down(low[i]);
    box.high[axis] = -rounded_down(-high[i]);
  }
  return box;
}

TriangleBox joined_box(const TriangleBox& a, const TriangleBox& b) {
  TriangleBox box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(a.low[axis], b.low[axis]);
    box.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return box;
}

}  // namespace

struct TriangleTree::Builder {
  TriangleTree& tree;
  std::vector<TriangleBox> triangle_boxes;

  [[nodiscard]] TriangleBox box_around(const Branch& branch) const {
    TriangleBox box = triangle_boxes[tree.order_[branch.begin]];
    for (std::size_t i = branch.begin + 1; i < branch.end; ++i)
      box = joined_box(box, triangle_boxes[tree.order_[i]]);
    return box;
  }

  void build(const Branch& branch) {
    tree.boxes_[branch.node] = box_around(branch);
    if (branch.node >= tree.first_leaf_) return;
    const std::pair<Branch, Branch> children = halves(branch);
    split(branch, children.second.begin);
    const auto build_first = [&] { build(children.first); };
    const auto build_second = [&] { build(children.second); };
    if (branch.end - branch.begin > kWorthAThread) {
      run_both(build_first, build_second);
    } else {
      build_first();
      build_second();
    }
  }

  [[nodiscard]] float centre(std::uint32_t triangle, std::size_t axis) const {
    return triangle_boxes[triangle].low[axis] + triangle_boxes[triangle].high[axis];
  }

  /// The number of triangles side by side along an axis: the span of their centres over their mean width.
  [[nodiscard]] double layers(const Branch& branch, std::size_t axis) const {
    double width = 0;
    float low = std::numeric_limits<float>::infinity();
    float high = -low;
    for (std::size_t i = branch.begin; i < branch.end; ++i) {
      const std::uint32_t triangle = tree.order_[i];
      width += double{triangle_boxes[triangle].high[axis]} - double{triangle_boxes[triangle].low[axis]};
      low = std::min(low, centre(triangle, axis));
      high = std::max(high, centre(triangle, axis));
    }
    return high > low ? (double{high} - double{low}) * static_cast<double>(branch.end - branch.begin) / width
                      : 0;
  }

  void split(const Branch& branch, std::size_t middle) {
    std::size_t axis = 0;
    double maximum = -1;
    for (std::size_t i = 0; i < 3; ++i)
      if (const double found = layers(branch, i); found > maximum) {
        maximum = found;
        axis = i;
      }
    const auto element = [&](std::size_t i) { return tree.order_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(element(branch.begin), element(middle), element(branch.end),
                     [&](std::uint32_t a, std::uint32_t b) {
                       return centre(a, axis) != centre(b, axis) ? centre(a, axis) < centre(b, axis) : a < b;
                     });
  }
};

TriangleTree::TriangleTree(const IndexedTriangles& mesh) : order_(mesh.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0U);
  std::size_t leaves = 1;
  while ((order_.size() + leaves - 1) / leaves > kLeafSize) leaves *= 2;
  first_leaf_ = leaves - 1;
  boxes_.resize(2 * leaves - 1);
  Builder builder{*this, std::vector<TriangleBox>(order_.size())};
  parallel_for(order_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) builder.triangle_boxes[i] = box_around(mesh.corners(i));
  });
  builder.build({0, 0, order_.size()});
}

}  // namespace landfall
