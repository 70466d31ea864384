// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D454
#include "chain/likeness/spacing.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "chain/likeness/two_samples.h"

namespace landfall {
namespace {

constexpr std::size_t kAcrossSample = 8192;
constexpr std::int64_t kMaxRings = 64;

Horizontal between(const Horizontal& from, const Horizontal& to) { return {to.x - from.x, to.y - from.y}; }

/// The places by cells of a lattice, sorted by row and column.
class PlaceIndex {
 public:
  PlaceIndex(std::span<const Horizontal> places, double cell_m) : cells_{.resolution_m = cell_m} {
    for (const Horizontal& place : places) sorted_.push_back({cells_.bin_of(place.x, place.y), place});
    std::ranges::sort(sorted_, {}, &IndexedPlace::key);
  }

  /// The distance from a place to the nearest one across a direction; NaN without one.
  [[nodiscard]] double nearest_across(const Horizontal& place, const Horizontal& direction) const {
    const BinIndex centre = cells_.bin_of(place.x, place.y);
    double best = std::numeric_limits<double>::infinity();
    for (std::int64_t ring = 0; ring <= kMaxRings; ++ring) {
      // A place of this ring or a farther one is at least (ring - 1) cells away.
      if (best <= static_cast<double>(ring - 1) * cells_.resolution_m) break;
      for (std::int64_t row = centre.row - ring; row <= centre.row + ring; ++row) {
        const bool is_edge = row == centre.row - ring || row == centre.row + ring;
        for (std::int64_t col = centre.col - ring; col <= centre.col + ring;
             col += is_edge ? 1 : std::max<std::int64_t>(1, 2 * ring))
          best = std::min(best, nearest_in({row, col}, place, direction));
      }
    }
    return std::isfinite(best) ? best : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  struct IndexedPlace {
    BinIndex cell;
    Horizontal place;
    [[nodiscard]] std::pair<std::int64_t, std::int64_t> key() const { return {cell.row, cell.col}; }
  };

  [[nodiscard]] double nearest_in(const BinIndex& cell, const Horizontal& from,
                                  const Horizontal& direction) const {
    double best = std::numeric_limits<double>::infinity();
    const std::pair key(cell.row, cell.col);
    for (auto each = std::ranges::lower_bound(sorted_, key, {}, &IndexedPlace::key);
         each != sorted_.end() && each->key() == key; ++each) {
      const Horizontal step = between(from, each->place);
      const double along = step.x * direction.x + step.y * direction.y;
      const double across = step.x * direction.y - step.y * direction.x;
      if (std::abs(across) > std::abs(along)) best = std::min(best, portable::hypot(step.x, step.y));
    }
    return best;
  }

  GridSpec cells_;
  std::vector<IndexedPlace> sorted_;
};

}  // namespace

Spacings spacings_of(std::span<const Horizontal> places, double cell_m) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Spacings spacings{std::vector<double>(places.size(), kNone), std::vector<double>(places.size(), kNone)};
  for (std::size_t i = 0; i + 1 < places.size(); ++i) {
    const Horizontal step = between(places[i], places[i + 1]);
    spacings.along[i] = portable::hypot(step.x, step.y);
  }
  const PlaceIndex index(places, cell_m);
  const std::vector<std::size_t> sample = sample_of(places.size(), kAcrossSample);
  parallel_for(sample.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const std::size_t i = sample[k];
      if (i == 0 || i + 1 == places.size()) continue;
      spacings.across[i] = index.nearest_across(places[i], between(places[i - 1], places[i + 1]));
    }
  });
  return spacings;
}

}  // namespace landfall
