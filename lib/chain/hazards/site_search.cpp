// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/site_search.h"

#include <algorithm>
#include <cmath>

#include "base/raster/distance_transform.h"
#include "base/raster/grid.h"

namespace landfall {
namespace {

struct SearchTile {
  GridSpec part;
  std::optional<FoundSite> best;  ///< with no or few sites before: a bound of what is left
};

/// The bin of `from` as one of `to`, in which it need not lie.
BinIndex seen_from(const GridSpec& from, const GridSpec& to, BinIndex bin) {
  return {bin.row + from.first_row - to.first_row, bin.col + from.first_col - to.first_col};
}

class SiteSearch {
 public:
  SiteSearch(const JudgedPlaces& places, const SiteParameters& parameters, std::int64_t tile_bins)
      : places_(places), parameters_(parameters), area_(reachable_area(parameters)) {
    const GridSpec& map = spec();
    for (std::int64_t row = 0; row < map.rows; row += tile_bins)
      for (std::int64_t col = 0; col < map.cols; col += tile_bins)
        tiles_.push_back({part_of(map, {row, col}, std::min(tile_bins, map.rows - row),
                                  std::min(tile_bins, map.cols - col)),
                          std::nullopt});
    for (SearchTile& tile : tiles_)
      if (is_reached(tile.part)) search_again(tile);
  }

  /// The best place that is apart from all before.
  std::optional<FoundSite> next() {
    for (;;) {
      const auto best = std::ranges::max_element(
          tiles_, [&](const SearchTile& a, const SearchTile& b) { return is_behind(a.best, b.best); });
      if (best == tiles_.end() || !best->best) return std::nullopt;
      const FoundSite found = *best->best;
      const bool fits = std::ranges::all_of(
          sites_, [&](BinIndex site) { return is_apart(spec(), found.bin, site, parameters_); });
      if (fits) sites_.push_back(found.bin);
      search_again(*best);
      if (fits) return found;
    }
  }

 private:
  [[nodiscard]] const GridSpec& spec() const { return places_.safe.spec(); }

  [[nodiscard]] bool is_behind(const std::optional<FoundSite>& a, const std::optional<FoundSite>& b) const {
    if (!a || !b) return !a && b;
    return is_better(spec(), {b->bin, b->cost}, {a->bin, a->cost});
  }

  [[nodiscard]] bool is_reached(const GridSpec& part) const {
    for (std::int64_t row = 0; row < part.rows; ++row)
      for (std::int64_t col = 0; col < part.cols; ++col)
        if (area_.contains({part.x(col), part.y(row)})) return true;
    return false;
  }

  /// The part with the bins that count in its p_touchdown.
  [[nodiscard]] GridSpec widened(const GridSpec& part) const {
    const double reach_m = touchdown_reach_m(places_.touchdown_sigma_m);
    const double maximum = static_cast<double>(std::max(spec().rows, spec().cols));
    const auto reach =
        static_cast<std::int64_t>(std::min(std::floor(reach_m / part.resolution_m) + 1, maximum));
    const BinIndex first = seen_from(part, spec(), {0, 0});
    const BinIndex from{std::max<std::int64_t>(first.row - reach, 0),
                        std::max<std::int64_t>(first.col - reach, 0)};
    return part_of(spec(), from, std::min(first.row + part.rows + reach, spec().rows) - from.row,
                   std::min(first.col + part.cols + reach, spec().cols) - from.col);
  }

  [[nodiscard]] Grid<float> touchdown(const GridSpec& part) const {
    const GridSpec window = widened(part);
    auto counted = Grid<float>::unset(window);
    std::ranges::transform(cut_out(places_.safe, window).values(), counted.values().begin(), [](auto safe) {
      return safe == static_cast<std::int8_t>(Safety::safe) ? 1.0F : 0.0F;
    });
    return cut_out(touchdown_probability(counted, places_.touchdown_sigma_m, cut_out(places_.region, window)),
                   part);
  }

  void search_again(SearchTile& tile) const {
    const Grid<float> p = touchdown(tile.part);
    std::vector<BinIndex> sites;
    for (const BinIndex site : sites_) sites.push_back(seen_from(spec(), tile.part, site));
    const auto place =
        best_place(landing_cost(p, parameters_), cut_out(places_.safe, tile.part), sites, parameters_);
    tile.best = std::nullopt;
    if (place) tile.best = {seen_from(tile.part, spec(), place->bin), place->cost, p.at(place->bin)};
  }

  JudgedPlaces places_;
  const SiteParameters& parameters_;
  ReachableArea area_;
  std::vector<SearchTile> tiles_;
  std::vector<BinIndex> sites_;
};

}  // namespace

std::vector<FoundSite> find_sites(const JudgedPlaces& places, const SiteParameters& parameters,
                                  std::int64_t tile_bins) {
  SiteSearch search(places, parameters, tile_bins);
  std::vector<FoundSite> found;
  while (static_cast<std::int64_t>(found.size()) < parameters.count) {
    const std::optional<FoundSite> site = search.next();
    if (!site) break;
    found.push_back(*site);
  }
  return found;
}

std::optional<float> hazard_distance_at(const JudgedPlaces& places, BinIndex bin) {
  const GridSpec& spec = places.safe.spec();
  std::int64_t minimum = kNoValidBin;
  const auto try_bin = [&](BinIndex at, std::int64_t squared) {
    if (squared < minimum && spec.contains(at) && places.region.at(at) != 0 &&
        places.safe.at(at) != static_cast<std::int8_t>(Safety::safe))
      minimum = squared;
  };
  for (std::int64_t rows = 0; rows < spec.rows && rows * rows < minimum; ++rows)
    for (std::int64_t cols = 0; cols < spec.cols && rows * rows + cols * cols < minimum; ++cols)
      for (const std::int64_t row : {bin.row - rows, bin.row + rows})
        for (const std::int64_t col : {bin.col - cols, bin.col + cols})
          try_bin({row, col}, rows * rows + cols * cols);
  if (minimum == kNoValidBin) return std::nullopt;
  return static_cast<float>(bins_apart(minimum) * spec.resolution_m);
}

}  // namespace landfall
