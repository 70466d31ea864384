// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace landfall {

/// x and y, metres.
using PointPlace = std::array<double, 2>;

/// Some points of a cloud: their rows, ascending, and the squares of which each keeps one.
struct ThinnedPoints {
  std::vector<std::uint64_t> rows;
  double cell_m = 0;  ///< 0: no point is left out
};

/// Chooses at most a given number of points of a cloud so that they cover it evenly from above, whatever
/// their order: of the points in each square of a grid, one at random, by a hash of its row (D418). The
/// choice depends on nothing but the points. Memory: about 200 bytes for each point to keep.
class PointThinning {
 public:
  /// All points lie between `low` and `high`. `cell_m`: squares that are certainly small enough; any value is
  /// allowed, but a much smaller one takes longer. `max_points` is at least 1.
  PointThinning(const PointPlace& low, const PointPlace& high, double cell_m, std::size_t max_points);

  void add(const PointPlace& place, std::uint64_t row);
  [[nodiscard]] ThinnedPoints finish();

 private:
  static constexpr std::size_t kSpare = 4;  ///< squares for each point to keep, before the last choice

  struct Candidate {
    std::array<std::uint32_t, 2> place{};  ///< in units of unit_m_
    std::uint64_t row = 0;
  };
  /// The number of the candidate's square, of squares of `edge` units.
  [[nodiscard]] static std::uint64_t cell_of(const Candidate& candidate, std::uint64_t edge);
  [[nodiscard]] static std::vector<Candidate> one_per_cell(const std::vector<Candidate>& candidates,
                                                           std::uint64_t edge);
  /// About, if there are many.
  [[nodiscard]] std::size_t cells(std::uint64_t edge) const;
  [[nodiscard]] std::uint64_t last_edge() const;

  PointPlace low_;
  double unit_m_;
  std::size_t max_points_;
  std::uint64_t edge_;
  std::size_t added_ = 0;
  bool is_thinned_ = false;
  std::vector<Candidate> candidates_;
};

}  // namespace landfall
