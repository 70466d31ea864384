// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D457
#include "chain/likeness/likeness.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "chain/evaluation/quantile/quantile.h"
#include "chain/gridding/posting.h"
#include "chain/likeness/spacing.h"

namespace landfall {
namespace {

constexpr std::size_t kMinReturns = 100;
constexpr std::size_t kPositions = 2048;
constexpr double kSpacingsPerBin = 2;
constexpr int kMaxShiftSteps = 20;  // of the shift between the scans as they are
constexpr double kMinOverlap = 0.5;
constexpr double kSignificantP = 0.01;
constexpr double kNmadPerMad = 1.4826;

struct TwoScans {
  const ComparedScan& a;
  const ComparedScan& b;
  [[nodiscard]] const ComparedScan& of(std::size_t scan) const { return scan == 0 ? a : b; }
};

/// A statistic whose distances are known for any sides.
struct Measured {
  LikenessStatistic statistic;
  TwoSamples samples;
};

/// The values of both scans, each multiplied by the factor of its scan.
std::vector<BlockValue> scaled_values(const ReturnQuantity& a, const ReturnQuantity& b,
                                      const std::array<double, 2>& factor) {
  std::vector<BlockValue> values;
  for (const auto& [scan, quantity] : {std::pair<std::size_t, const ReturnQuantity*>{0, &a}, {1, &b}})
    for (std::size_t i = 0; i < quantity->values.size(); ++i)
      values.push_back({quantity->values[i] * factor.at(scan), block_of(i, quantity->values.size(), scan)});
  return values;
}

/// The level that is shown of a scan.
double level_of(const ReturnQuantity& quantity) {
  const bool is_error = quantity.kind == ReturnQuantity::Kind::error;
  std::vector<double> values;
  for (const double value : quantity.values)
    if (!std::isnan(value)) values.push_back(is_error ? kNmadPerMad * std::abs(value) : value);
  return quantile_in_place(values, 0.5);
}

Measured measured(const ReturnQuantity& a, const ReturnQuantity& b) {
  LikenessStatistic statistic{.name = a.name, .unit = a.unit, .a = level_of(a), .b = level_of(b)};
  const bool is_relative = a.kind == ReturnQuantity::Kind::relative;
  return {statistic,
          TwoSamples(scaled_values(
              a, b, is_relative ? std::array{1 / statistic.a, 1 / statistic.b} : std::array{1.0, 1.0}))};
}

/// The spacing of the first returns along and across the scan direction.
std::array<ReturnQuantity, 2> spacings_of_first(const ComparedScan& scan) {
  if (scan.x.size() < kMinReturns)
    throw UsageError("fewer than " + std::to_string(kMinReturns) + " returns are too few to compare");
  const auto x = std::ranges::minmax(scan.x), y = std::ranges::minmax(scan.y);
  const double width = x.max - x.min, height = y.max - y.min;
  if (width == 0 && height == 0) throw UsageError("all returns lie on one point");
  const auto count = static_cast<double>(scan.x.size());
  std::vector<Horizontal> places;
  for (std::size_t i = 0; i < scan.x.size(); ++i)
    if (scan.number.empty() || scan.number[i] <= 1) places.push_back({scan.x[i], scan.y[i]});
  Spacings spacings =
      spacings_of(places, std::max(std::max(width, height) / count, std::sqrt(width * height / count)));
  return {ReturnQuantity{.name = "spacing_along", .unit = "m", .values = std::move(spacings.along)},
          ReturnQuantity{.name = "spacing_across", .unit = "m", .values = std::move(spacings.across)}};
}

/// The posting of the bins: 1, 2 or 5 x 10^k m, at most kSpacingsPerBin times the largest median spacing.
double posting_of(const std::array<std::array<ReturnQuantity, 2>, 2>& spacings) {
  double largest = 0;
  for (const auto& scan : spacings)
    for (const ReturnQuantity& each : scan) largest = std::fmax(largest, level_of(each));
  if (largest == 0) throw UsageError("most returns lie on one point");
  return Posting::at_most(kSpacingsPerBin * largest).metres();
}

/// Values of each return that need the bins.
std::array<ReturnQuantity, 2> of_surface(const BinnedScans& scans, const ComparedScan& scan,
                                         std::size_t which, const std::vector<Gradient>& gradients) {
  const std::vector<ReturnSum> sums = scans.sums(original_sides()).at(which);
  ReturnQuantity roughness{.name = "roughness", .unit = "m", .kind = ReturnQuantity::Kind::error};
  ReturnQuantity incidence{.name = "incidence", .unit = "deg"};
  for (std::size_t i = 0; i < scan.x.size(); ++i) {
    const std::uint32_t bin = scans.bin_of_return(which)[i];
    const ReturnSum& sum = sums[bin];
    const Gradient& g = gradients[bin];
    const double height = scan.z[i] - sum.z / sum.count - g.x * (scan.x[i] - sum.x / sum.count) -
                          g.y * (scan.y[i] - sum.y / sum.count);
    roughness.values.push_back(sum.count >= 3 ? height * std::sqrt(sum.count / (sum.count - 1))
                                              : LikenessStatistic::kNone);
    if (scan.px.empty()) continue;
    const double x = scan.px[i] - scan.x[i], y = scan.py[i] - scan.y[i], z = scan.pz[i] - scan.z[i];
    const double lengths = std::sqrt((x * x + y * y + z * z) * (g.x * g.x + g.y * g.y + 1));
    incidence.values.push_back(portable::acos(std::clamp((z - g.x * x - g.y * y) / lengths, -1.0, 1.0)) *
                               180 / std::numbers::pi);
  }
  return {std::move(roughness), std::move(incidence)};
}

std::vector<TwoClouds::Position> positions_of(const TwoScans& scans) {
  std::vector<TwoClouds::Position> positions;
  for (std::size_t scan = 0; scan < 2; ++scan) {
    const ComparedScan& s = scans.of(scan);
    for (const std::size_t i : sample_of(s.x.size(), kPositions))
      positions.push_back({s.x[i], s.y[i], s.z[i], block_of(i, s.x.size(), scan)});
  }
  return positions;
}

/// All statistics of two scans, for any exchange of blocks.
class Comparison {
 public:
  explicit Comparison(const TwoScans& scans)
      : Comparison(scans, {spacings_of_first(scans.a), spacings_of_first(scans.b)}) {}

 private:
  Comparison(const TwoScans& scans, const std::array<std::array<ReturnQuantity, 2>, 2>& spacings)
      : has_times_(!scans.a.t.empty() && !scans.b.t.empty()),
        bins_(scans.a, scans.b, posting_of(spacings)),
        gradients_(bins_.gradients()),
        clouds_(positions_of(scans)) {
    for (std::size_t k = 0; k < 2; ++k) quantities_.push_back(measured(spacings[0].at(k), spacings[1].at(k)));
    auto a = of_surface(bins_, scans.a, 0, gradients_);
    auto b = of_surface(bins_, scans.b, 1, gradients_);
    for (std::size_t k = 0; k < 2; ++k)
      if (!a.at(k).values.empty() && !b.at(k).values.empty())
        quantities_.push_back(measured(a.at(k), b.at(k)));
    for (const ReturnQuantity& quantity : scans.a.quantities) {
      const auto other = std::ranges::find(scans.b.quantities, quantity.name, &ReturnQuantity::name);
      if (other != scans.b.quantities.end()) quantities_.push_back(measured(quantity, *other));
    }
  }

 public:
  [[nodiscard]] const BinnedScans& bins() const { return bins_; }
  [[nodiscard]] SurfaceDifference surface() const {
    return surface_difference(bins_, gradients_, bins_.sums(original_sides()), kMaxShiftSteps);
  }

  /// The statistics without distances and chance levels.
  [[nodiscard]] std::vector<LikenessStatistic> statistics() const {
    const ReturnSums sums = bins_.sums(original_sides());
    const auto covered = [&](std::size_t side) {
      return static_cast<double>(
          std::ranges::count_if(sums.at(side), [](const ReturnSum& sum) { return sum.count > 0; }));
    };
    const auto density = [&](std::size_t side) {
      double count = 0;
      for (const ReturnSum& sum : sums.at(side)) count += sum.count;
      return count / covered(side);
    };
    std::vector<LikenessStatistic> list = {{.name = "density", .a = density(0), .b = density(1)},
                                           {.name = "density_map"},
                                           {.name = "coverage", .a = covered(0), .b = covered(1)}};
    if (has_times_) list.push_back({.name = "coverage_time"});
    list.push_back({.name = "position", .distance_unit = "m^0.5"});
    for (const auto& [name, unit] : {std::pair("elevation", "m"), std::pair("elevation_spread", "m"),
                                     std::pair("shift", "m"), std::pair("tilt", "rad")})
      list.push_back({.name = name, .distance_unit = unit});
    for (const Measured& each : quantities_) list.push_back(each.statistic);
    return list;
  }

  /// The number of statistics() that compare places.
  [[nodiscard]] std::size_t place_count() const { return statistics().size() - quantities_.size(); }

  /// The distances in the order of statistics().
  [[nodiscard]] std::vector<double> distances(const Sides& sides) const {
    const ReturnSums sums = bins_.sums(sides);
    const CoverageDifference map = coverage_difference(sums);
    const SurfaceDifference surface = surface_difference(bins_, gradients_, sums);
    std::vector<double> list = {map.counts_ks, map.decorrelation, map.only_one};
    if (has_times_) list.push_back(map.over_time);
    list.push_back(clouds_.energy_distance(sides));
    list.push_back(std::abs(surface.median_m));
    list.push_back(surface.nmad_m);
    list.push_back(portable::hypot(surface.shift_x_m, surface.shift_y_m));
    list.push_back(portable::hypot(surface.tilt_x_rad, surface.tilt_y_rad));
    for (const Measured& each : quantities_) list.push_back(each.samples.ks_distance(sides));
    return list;
  }

 private:
  bool has_times_;
  BinnedScans bins_;
  std::vector<Gradient> gradients_;
  TwoClouds clouds_;
  std::vector<Measured> quantities_;
};

/// Sets distances, chance levels and p.
void set_distances(const Comparison& comparison, Likeness& likeness, const ProgressCallback& progress) {
  std::vector<LikenessStatistic>& statistics = likeness.statistics;
  const std::vector<double> found = comparison.distances(original_sides());
  std::vector<std::vector<double>> by_exchange(kExchanges);
  parallel_for(
      kExchanges, 1,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e) by_exchange[e] = comparison.distances(exchanged_sides(e));
      },
      progress);
  for (std::size_t s = 0; s < statistics.size(); ++s) {
    statistics[s].distance = found[s];
    const bool is_known = statistics[s].name != "elevation_spread" && std::isfinite(found[s]) &&
                          (likeness.block_overlap >= kMinOverlap || s >= comparison.place_count());
    if (!is_known) continue;
    std::vector<double> exchanged;
    for (const std::vector<double>& each : by_exchange)
      exchanged.push_back(std::isnan(each[s]) ? std::numeric_limits<double>::infinity() : each[s]);
    std::ranges::sort(exchanged, std::greater<>());
    const auto reached = std::ranges::count_if(exchanged, [&](double d) { return d >= found[s]; });
    statistics[s].chance = exchanged[1];
    statistics[s].p = static_cast<double>(1 + reached) / static_cast<double>(1 + kExchanges);
  }
}

/// The grid of all bins, and the maps of both scans.
void set_maps(const BinnedScans& scans, Likeness& likeness) {
  const auto rows = std::ranges::minmax(scans.bins(), {}, &BinIndex::row);
  const auto cols = std::ranges::minmax(scans.bins(), {}, &BinIndex::col);
  likeness.grid = {scans.posting_m(), rows.min.row, cols.min.col, rows.max.row - rows.min.row + 1,
                   cols.max.col - cols.min.col + 1};
  const ReturnSums sums = scans.sums(original_sides());
  for (std::size_t side = 0; side < 2; ++side) {
    likeness.counts.at(side) = Grid<double>(likeness.grid, 0);
    likeness.elevations.at(side) = Grid<double>(likeness.grid, LikenessStatistic::kNone);
    for (std::size_t i = 0; i < scans.bins().size(); ++i) {
      const ReturnSum& sum = sums.at(side)[i];
      if (sum.count == 0) continue;
      const BinIndex bin{scans.bins()[i].row - likeness.grid.first_row,
                         scans.bins()[i].col - likeness.grid.first_col};
      likeness.counts.at(side).at(bin) = sum.count;
      likeness.elevations.at(side).at(bin) = sum.z / sum.count;
    }
  }
}

std::vector<std::string> quantities_of_one(const TwoScans& scans) {
  std::vector<std::string> names;
  for (const auto& [mine, other] : {std::pair(&scans.a, &scans.b), std::pair(&scans.b, &scans.a)})
    for (const ReturnQuantity& quantity : mine->quantities)
      if (std::ranges::find(other->quantities, quantity.name, &ReturnQuantity::name) ==
          other->quantities.end())
        names.push_back(quantity.name);
  if (scans.a.px.empty() != scans.b.px.empty()) names.emplace_back("incidence");
  if (scans.a.t.empty() != scans.b.t.empty()) names.emplace_back("coverage_time");
  return names;
}

}  // namespace

std::optional<bool> LikenessStatistic::differs() const {
  return std::isnan(p) ? std::nullopt : std::optional(p <= kSignificantP);
}

Likeness likeness_of(const ComparedScan& a, const ComparedScan& b, bool with_maps,
                     const ProgressCallback& progress) {
  const TwoScans scans{a, b};
  const Comparison comparison(scans);
  const BinnedScans& bins = comparison.bins();
  Likeness likeness{.posting_m = bins.posting_m(),
                    .bins = bins.bins().size(),
                    .block_overlap = bins.block_overlap(),
                    .statistics = comparison.statistics(),
                    .not_in_both = quantities_of_one(scans),
                    .surface = comparison.surface()};
  const ReturnSums sums = bins.sums(original_sides());
  if (!a.t.empty()) likeness.covered_a = covered_over_time(sums[0]);
  if (!b.t.empty()) likeness.covered_b = covered_over_time(sums[1]);
  set_distances(comparison, likeness, progress);
  if (with_maps) set_maps(bins, likeness);
  return likeness;
}

}  // namespace landfall
