// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace landfall {

using PointPlace = std::array<double, 3>;

/// Some points of a cloud: their rows, ascending, and the cubes of which each keeps one.
struct ThinnedPoints {
  std::vector<std::uint64_t> rows;
  double cell_m = 0;  ///< 0: no point is left out
};

/// Chooses at most a given number of points of a cloud so that they cover it evenly, whatever their order: of
/// the points in each cube of a grid, the one nearest to the middle of the cube. Points are added in rows
/// ascending; the choice depends on nothing else. Memory: 200 bytes for each point to keep.
class PointThinning {
 public:
  /// All points lie between `low` and `high`. `cell_m`: cubes that are certainly small enough; any value is
  /// allowed, but a much smaller one takes longer. `most` is at least 1.
  PointThinning(const PointPlace& low, const PointPlace& high, double cell_m, std::size_t most);

  void add(const PointPlace& place, std::uint64_t row);
  [[nodiscard]] ThinnedPoints finish();

 private:
  static constexpr int kBits = 21;          ///< of the number of a cube along one axis
  static constexpr int kFineBits = 32;      ///< of a place along one axis
  static constexpr std::size_t kSpare = 4;  ///< cubes for each point to keep, before the last choice

  struct Candidate {
    std::array<std::uint32_t, 3> place{};  ///< in units of unit_m_
    std::uint64_t row = 0;
  };
  struct Cell {
    std::uint64_t number;
    double distance;  ///< from the middle to the candidate, squared, units
  };
  /// Of cubes of `edge` units.
  [[nodiscard]] static Cell cell_of(const Candidate& candidate, std::uint64_t edge);
  [[nodiscard]] static std::vector<Candidate> one_per_cell(const std::vector<Candidate>& candidates,
                                                           std::uint64_t edge);
  /// About, if there are many.
  [[nodiscard]] std::size_t cells(std::uint64_t edge) const;
  [[nodiscard]] std::uint64_t last_edge() const;

  PointPlace low_;
  double unit_m_;
  std::size_t most_;
  std::uint64_t edge_;
  std::size_t added_ = 0;
  bool is_thinned_ = false;
  std::vector<Candidate> candidates_;
};

}  // namespace landfall
