// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D25
#include "base/raster/holes.h"

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

/// The labels of set bins in row-major order, from those of their neighbours already visited: west and the
/// three in the row below.
class BinLabeller {
 public:
  BinLabeller(std::span<const std::uint32_t> bins, std::int64_t cols)
      : bins_(bins), cols_(cols), labels_(bins.size()) {}

  /// Final ids by bin.
  std::vector<std::int32_t> run() {
    for (std::size_t i = 0; i < bins_.size(); ++i) labels_[i] = provisional_label(i);
    const std::vector<std::int32_t> ids = sets_.final_ids();
    for (std::int32_t& label : labels_) label = ids[static_cast<std::size_t>(label)];
    return std::move(labels_);
  }

 private:
  std::int32_t provisional_label(std::size_t i) {
    const std::int64_t index = bins_[i];
    const std::int64_t col = index % cols_;
    const std::int64_t west_below = index - cols_ - (col > 0 ? 1 : 0);
    const std::int64_t east_below = index - cols_ + (col + 1 < cols_ ? 1 : 0);
    while (bins_[below_] < west_below) ++below_;
    std::int32_t label = col > 0 && i > 0 && bins_[i - 1] == index - 1 ? labels_[i - 1] : 0;
    for (std::size_t k = below_; bins_[k] <= east_below; ++k)
      if (labels_[k] != label) label = label == 0 ? labels_[k] : sets_.unite(label, labels_[k]);
    return label == 0 ? sets_.add() : label;
  }

  std::span<const std::uint32_t> bins_;
  std::int64_t cols_;
  std::vector<std::int32_t> labels_;
  LabelSets sets_;
  std::size_t below_ = 0;  ///< the first bin not before the south-western neighbour
};

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

BinLabels label_bins(const GridSpec& spec, std::span<const std::uint32_t> bins) {
  BinLabels result{BinLabeller(bins, spec.cols).run(), {}};
  if (bins.empty()) return result;
  result.holes.resize(static_cast<std::size_t>(std::ranges::max(result.id)));
  for (std::size_t i = 0; i < bins.size(); ++i) {
    Hole& hole = result.holes[static_cast<std::size_t>(result.id[i] - 1)];
    hole.id = result.id[i];
    add_bin(hole, {bins[i] / spec.cols, bins[i] % spec.cols});
  }
  for (Hole& hole : result.holes) finish(hole, spec);
  return result;
}

HoleLabels label_holes(const BinMask& mask) {
  std::vector<std::uint32_t> bins;
  for (std::size_t i = 0; i < mask.values().size(); ++i)
    if (mask.values()[i] != 0) bins.push_back(static_cast<std::uint32_t>(i));
  BinLabels labels = label_bins(mask.spec(), bins);
  HoleLabels result{Grid<std::int32_t>(mask.spec()), std::move(labels.holes)};
  for (std::size_t i = 0; i < bins.size(); ++i) result.id.values()[bins[i]] = labels.id[i];
  return result;
}

}  // namespace landfall
