// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D419
#include "chain/hazards/strip_map.h"

#include <algorithm>

#include "base/core/error.h"
#include "base/memory/available_memory.h"
#include "base/raster/grid.h"
#include "base/raster/grid_spec.h"
#include "chain/hazards/hole_filling.h"
#include "chain/hazards/map_judge.h"
#include "chain/hazards/site_search.h"

namespace landfall {
namespace {

constexpr std::int64_t kSiteTile = 1024;

// At least: region and safe of the map; elevations, with a margin, and measures of a strip.
constexpr std::uint64_t kBytesPerMapBin = 2;
constexpr std::uint64_t kBytesPerStripBin = 46;

/// Rows around a strip that its measures need. A hole of n bins that is filled lies within n - 1 rows of each
/// of its bins, and one that reaches the border of the loaded rows is larger.
std::int64_t halo_rows(const MapJudge& judge, const HazardParameters& parameters) {
  return judge.reach_bins() + parameters.hole_fill_bins;
}

GridSpec rows_of(const GridSpec& map, std::int64_t first, std::int64_t end) {
  return part_of(map, {first, 0}, end - first, map.cols);
}

class StripJudge {
 public:
  StripJudge(const StripSource& source, const HazardParameters& parameters)
      : source_(source), parameters_(parameters), judge_(parameters, source.spec) {}

  /// The elevations of these rows and of those around them, with small holes filled.
  [[nodiscard]] Grid<double> filled(std::int64_t first, std::int64_t end) const {
    const std::int64_t halo = halo_rows(judge_, parameters_);
    Grid<double> z = source_.load(rows_of(source_.spec, std::max<std::int64_t>(first - halo, 0),
                                          std::min(end + halo, source_.spec.rows)));
    fill_holes(z, small_holes(z, parameters_.hole_fill_bins));
    return z;
  }

  [[nodiscard]] std::uint64_t needed_bytes() const {
    const std::int64_t rows = source_.strip_rows + 2 * halo_rows(judge_, parameters_);
    const auto strip_bins = static_cast<std::uint64_t>(std::min(rows, source_.spec.rows) * source_.spec.cols);
    return kBytesPerMapBin * source_.spec.size() + kBytesPerStripBin * strip_bins;
  }

  /// The measures of `places`, bins of the map, in the rows that z holds.
  [[nodiscard]] PlaceMeasures measure(const Grid<double>& z, const BinMask& places) const {
    BinMask wanted(z.spec());
    put_in(places, wanted);
    return judge_.measure(z, wanted);
  }

 private:
  const StripSource& source_;
  const HazardParameters& parameters_;
  MapJudge judge_;
};

PlaceMeasures cut_out(const PlaceMeasures& measures, const GridSpec& part) {
  return {cut_out(measures.slope_deg, part), cut_out(measures.roughness_m, part)};
}

/// Judges every strip; returns the places of the region that have an elevation.
std::int64_t judge_strips(const StripSource& source, const HazardParameters& parameters,
                          const StripJudge& judge, const TakeMeasures& take, HazardMap& map,
                          const ProgressCallback& progress) {
  std::int64_t known = 0;
  for (std::int64_t row = 0; row < source.spec.rows; row += source.strip_rows) {
    const std::int64_t end = std::min(row + source.strip_rows, source.spec.rows);
    const GridSpec strip = rows_of(source.spec, row, end);
    const Grid<double> z = judge.filled(row, end);
    const BinMask places = cut_out(map.region, strip);
    const PlaceMeasures measures = cut_out(judge.measure(z, places), strip);
    put_in(judge_places(measures, parameters.limits), map.safe);
    known += known_places(cut_out(z, strip), places);
    take(measures);
    report(progress, static_cast<double>(end) / static_cast<double>(source.spec.rows));
  }
  return known;
}

LandingSite described(const FoundSite& found, const HazardMap& map, const StripJudge& judge) {
  const GridSpec& spec = map.safe.spec();
  const GridSpec place = part_of(spec, found.bin, 1, 1);
  const Grid<double> z = judge.filled(found.bin.row, found.bin.row + 1);
  const PlaceMeasures measures = judge.measure(z, BinMask(place, 1));
  LandingSite site;
  site.bin = found.bin;
  site.x_m = spec.x(found.bin.col);
  site.y_m = spec.y(found.bin.row);
  site.z_m = cut_out(z, place).at({0, 0});
  site.cost = found.cost;
  site.p_touchdown = found.p_touchdown;
  site.slope_deg = cut_out(measures.slope_deg, place).at({0, 0});
  site.roughness_m = cut_out(measures.roughness_m, place).at({0, 0});
  return site;
}

}  // namespace

HazardMap map_strips(const StripSource& source, const HazardParameters& parameters, const TakeMeasures& take,
                     const PhaseRunner& phase) {
  const StripJudge judge(source, parameters);
  require_memory(judge.needed_bytes(), "judging " + size_text(source.spec) + " in strips",
                 "fill smaller holes (hole_fill_bins)");
  HazardMap map;
  map.region = region_of(source.spec, source.region, parameters);
  map.safe = Grid<std::int8_t>::unset(source.spec);
  std::int64_t known = 0;
  phase("judge", [&](const ProgressCallback& progress) {
    known = judge_strips(source, parameters, judge, take, map, progress);
  });
  const PlaceCounts counts = count_places(map.safe, map.region);
  if (counts.unknown == counts.all()) throw FormatError(unknown_reason(map.region, known, parameters));
  phase("sites", [&](const ProgressCallback&) {
    const JudgedPlaces places{map.safe, map.region, parameters.touchdown_sigma_m};
    for (const FoundSite& found : find_sites(places, parameters.sites, kSiteTile)) {
      LandingSite& site = map.sites.emplace_back(described(found, map, judge));
      if (counts.safe < counts.all()) site.hazard_distance_m = hazard_distance_at(places, found.bin);
    }
  });
  return map;
}

}  // namespace landfall
