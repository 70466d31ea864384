// SPDX-License-Identifier: GPL-3.0-or-later
#include "raster/holes.h"

#include <algorithm>
#include <utility>

namespace landfall {
namespace {

/// Disjoint sets of provisional labels. The root of a set is its smallest label. Labels are assigned in
/// row-major order, so the root is the label of the component's first bin.
class LabelSets {
 public:
  std::int32_t add() {
    parent_.push_back(static_cast<std::int32_t>(parent_.size()));
    return parent_.back();
  }

  std::int32_t root(std::int32_t label) {
    while (parent(label) != label) {
      parent(label) = parent(parent(label));
      label = parent(label);
    }
    return label;
  }

  /// Unites the sets and returns the root of the united set.
  std::int32_t unite(std::int32_t a, std::int32_t b) {
    a = root(a);
    b = root(b);
    if (a > b) std::swap(a, b);
    parent(b) = a;
    return a;
  }

  /// Final ids 1, 2, .. in the order of the roots, indexed by provisional label; label 0 stays 0.
  std::vector<std::int32_t> final_ids() {
    std::vector<std::int32_t> ids(parent_.size(), 0);
    std::int32_t next = 0;
    for (std::size_t label = 1; label < parent_.size(); ++label) {
      const auto r = static_cast<std::size_t>(root(static_cast<std::int32_t>(label)));
      ids[label] = r == label ? ++next : ids[r];
    }
    return ids;
  }

 private:
  std::int32_t& parent(std::int32_t label) { return parent_[static_cast<std::size_t>(label)]; }

  std::vector<std::int32_t> parent_{0};  // label 0 is the background
};

/// The label of a bin from its neighbours already visited: west and the three in the row below.
std::int32_t provisional_label(const Grid<std::int32_t>& labels, BinIndex bin, LabelSets& sets) {
  std::int32_t label = 0;
  const BinIndex neighbours[] = {
      {bin.row, bin.col - 1}, {bin.row - 1, bin.col - 1}, {bin.row - 1, bin.col}, {bin.row - 1, bin.col + 1}};
  for (const BinIndex neighbour : neighbours) {
    if (!labels.spec().contains(neighbour)) continue;
    const std::int32_t other = labels.at(neighbour);
    if (other == 0 || other == label) continue;
    label = label == 0 ? other : sets.unite(label, other);
  }
  return label == 0 ? sets.add() : label;
}

/// Adds the bin; the centroid fields hold sums of columns and rows until finish().
void add_bin(Hole& hole, BinIndex bin) {
  if (hole.size_bins == 0) hole.first = hole.south_west = hole.north_east = bin;
  ++hole.size_bins;
  hole.south_west = {std::min(hole.south_west.row, bin.row), std::min(hole.south_west.col, bin.col)};
  hole.north_east = {std::max(hole.north_east.row, bin.row), std::max(hole.north_east.col, bin.col)};
  hole.centroid_x_m += static_cast<double>(bin.col);
  hole.centroid_y_m += static_cast<double>(bin.row);
}

/// Turns the sums of columns and rows, exact below 2^53, into metres.
void finish(Hole& hole, const GridSpec& spec) {
  const auto size = static_cast<double>(hole.size_bins);
  hole.centroid_x_m = (static_cast<double>(spec.first_col) + hole.centroid_x_m / size) * spec.resolution_m;
  hole.centroid_y_m = (static_cast<double>(spec.first_row) + hole.centroid_y_m / size) * spec.resolution_m;
}

}  // namespace

HoleLabels label_holes(const BinMask& mask) {
  const GridSpec& spec = mask.spec();
  HoleLabels result{Grid<std::int32_t>::unset(spec), {}};
  LabelSets sets;
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      result.id.at({row, col}) =
          mask.at({row, col}) != 0 ? provisional_label(result.id, {row, col}, sets) : 0;

  const std::vector<std::int32_t> ids = sets.final_ids();
  result.holes.resize(static_cast<std::size_t>(*std::max_element(ids.begin(), ids.end())));
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      std::int32_t& id = result.id.at({row, col});
      if (id == 0) continue;
      id = ids[static_cast<std::size_t>(id)];
      Hole& hole = result.holes[static_cast<std::size_t>(id - 1)];
      hole.id = id;
      add_bin(hole, {row, col});
    }
  }
  for (Hole& hole : result.holes) finish(hole, spec);
  return result;
}

}  // namespace landfall
