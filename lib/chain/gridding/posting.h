// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "base/raster/grid_spec.h"

namespace landfall {

/// The convex hull of points that are added piece by piece.
class PointOutline {
 public:
  /// Takes finite coordinates.
  void add(std::span<const double> x_m, std::span<const double> y_m);

  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] const std::vector<Horizontal>& hull() const { return hull_; }
  [[nodiscard]] double area_m2() const;
  /// The larger side of the bounding box.
  [[nodiscard]] double extent_m() const;
  /// The largest |x| and |y|.
  [[nodiscard]] Horizontal reach_m() const;

 private:
  std::int64_t count_ = 0;
  std::vector<Horizontal> hull_;
};

/// A set of cells of an unbounded grid, a bit for each, in tiles of 64 x 64.
class CellSet {
 public:
  CellSet() = default;
  CellSet(const CellSet&) = delete;
  CellSet& operator=(const CellSet&) = delete;
  /// Rows and columns are less than 2^37 from 0.
  void insert(BinIndex cell);
  /// Calls use(cell) for each, in no particular order.
  void for_each(const std::function<void(BinIndex)>& use) const;

 private:
  using Tile = std::array<std::uint64_t, 64>;  // rows of columns
  std::unordered_map<std::uint64_t, Tile> tiles_;
  std::uint64_t last_key_ = 0;
  Tile* last_ = nullptr;
};

/// A posting of 1, 2 or 5 times a power of ten, metres.
struct Posting {
  int digit = 1;
  int exponent = 0;

  [[nodiscard]] double metres() const;
  [[nodiscard]] Posting next() const;  ///< the next coarser one
  /// The coarsest that is at most `limit_m`, which is finite and positive.
  [[nodiscard]] static Posting at_most(double limit_m);
};

/// Bins whose centre lies within the convex hull of points, and how many of those hold no point.
struct HullBins {
  std::int64_t inside = 0;
  std::int64_t empty = 0;
  [[nodiscard]] double empty_share() const {
    return inside > 0 ? static_cast<double>(empty) / static_cast<double>(inside) : 0;
  }
};

struct ChosenPosting {
  Posting posting;
  HullBins bins;
};

/// The most empty bins in the hull that a chosen posting leaves.
inline constexpr double kMaxEmptyShare = 0.05;

/// Searches the posting of a DEM: the bins that its points fill, counted exactly for each posting from one
/// set of finer cells, at most 2^32 in the hull.
class PostingSearch {
 public:
  /// From the first pass over the points. Their extent must not be 0.
  explicit PostingSearch(PointOutline outline);
  /// The second pass over the same points.
  void mark(std::span<const double> x_m, std::span<const double> y_m);

  /// The finest allowed posting that leaves at most kMaxEmptyShare of the bins in the hull empty. None if no
  /// posting up to four times the extent is allowed.
  [[nodiscard]] std::optional<ChosenPosting> finest(const std::function<bool(double)>& is_allowed) const;

 private:
  [[nodiscard]] HullBins bins(const Posting& posting) const;

  PointOutline outline_;
  Posting first_;  ///< no finer one can have so few empty bins
  double cell_m_;
  CellSet cells_;
};

/// Bins of any grid in the hull of points, and those that hold no point, from the grid's own bins.
[[nodiscard]] HullBins count_hull_bins(const std::vector<Horizontal>& hull, double resolution_m,
                                       const CellSet& filled);

}  // namespace landfall
