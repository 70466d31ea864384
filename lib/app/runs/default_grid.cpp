// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D446
#include "app/runs/default_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <utility>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "chain/gridding/posting.h"
#include "store/files/imported_scan.h"
#include "store/files/scan_gridding.h"

namespace landfall {
namespace {

constexpr const char* kResolution = "resolution_m";
constexpr const char* kHalfWidth = "half_width_m";
constexpr double kPoorShare = 0.5;

bool are_imported(const std::vector<std::string>& scans) {
  try {
    return std::ranges::all_of(
        scans, [](const std::string& path) { return is_imported_scan(LandfallFileReader(path, {"scan"})); });
  } catch (const FormatError&) {
    return false;
  }
}

/// A rectangle of points to look at.
struct Area {
  Horizontal center;
  Horizontal half{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

  [[nodiscard]] bool contains(double x_m, double y_m) const {
    return std::abs(x_m - center.x) <= half.x && std::abs(y_m - center.y) <= half.y;
  }
};

using UsePoints = std::function<void(std::span<const double> x_m, std::span<const double> y_m)>;

/// The returns of scans in an area of the first one's frame, batch by batch, from its centre.
void read_points(const DemSources& sources, const Area& area, const UsePoints& use) {
  Provenance unused;
  const Scans scans = open_scans(sources.scans, unused);
  const std::vector<Placement> placements = place_scans(scans, sources.rules).of;
  ScanPoints points;
  std::vector<double> x_m, y_m;
  for (std::size_t s = 0; s < scans.size(); ++s)
    for (std::size_t begin = 0; begin < scans[s]->row_count(); begin += kBatchRows) {
      scans[s]->read(begin, std::min(kBatchRows, scans[s]->row_count() - begin), points);
      std::vector<double>& x = points.columns.x_est;
      std::vector<double>& y = points.columns.y_est;
      placements[s].to_first(x, y);
      x_m.clear();
      y_m.clear();
      for (std::size_t i = 0; i < x.size(); ++i) {
        if (!area.contains(x[i], y[i])) continue;  // also a point without a position in the frame, NaN
        x_m.push_back(x[i] - area.center.x);
        y_m.push_back(y[i] - area.center.y);
      }
      use(x_m, y_m);
    }
}

PointOutline outline_of(const DemSources& sources, const Area& area) {
  PointOutline outline;
  read_points(sources, area, [&](auto x_m, auto y_m) { outline.add(x_m, y_m); });
  return outline;
}

/// Without the digits that a product of decimal numbers has.
double decimal(double value) { return std::round(value * 1e12) / 1e12; }

/// The half width that holds the bins of all points.
Horizontal half_width(const Horizontal& reach_m, double resolution_m) {
  const auto half = [&](double reach) {
    return decimal(std::max(1.0, std::floor(reach / resolution_m + 0.5)) * resolution_m);
  };
  return {half(reach_m.x), half(reach_m.y)};
}

/// Throws UsageError for a grid that is larger than any (base/raster/grid_spec.h).
void require_possible_size(const Horizontal& half_m, double resolution_m, const std::string& config_name) {
  if ((2 * half_m.x / resolution_m + 1) * (2 * half_m.y / resolution_m + 1) <= 0x1p30) return;
  throw UsageError(
      config_name + ": bins of " + number_text(resolution_m) + " m about center_m that reach the points, " +
      short_number(std::max(half_m.x, half_m.y)) +
      " m away, are more than 2^30: give center_m near the points, or half_width_m and resolution_m");
}

nlohmann::json json_of(const Horizontal& half_m) {
  if (half_m.x == half_m.y) return half_m.x;
  return {half_m.x, half_m.y};
}

/// x and y of a value that is one number or two; none where it is neither, which the schema refuses.
std::optional<Horizontal> numbers_of(const nlohmann::json& value) {
  if (value.is_number()) return Horizontal{value.get<double>(), value.get<double>()};
  if (value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number())
    return Horizontal{value[0].get<double>(), value[1].get<double>()};
  return std::nullopt;
}

bool is_multiple(double value, double resolution_m) {
  return std::abs(value / resolution_m - std::round(value / resolution_m)) <= 1e-9;
}

bool divides(double resolution_m, double half_width_m) {
  return std::round(half_width_m / resolution_m) >= 1 && is_multiple(half_width_m, resolution_m);
}

/// The grid that is chosen for points.
struct Choice {
  double resolution_m = 0;
  Horizontal half_m;
  std::optional<HullBins> bins{};  ///< of a chosen posting
};

/// The values of a configuration that bind the choice.
struct Given {
  std::optional<double> resolution_m;
  std::optional<Horizontal> half_m;
  Horizontal center_m;

  [[nodiscard]] bool allows(double posting_m) const {
    return is_multiple(center_m.x, posting_m) && is_multiple(center_m.y, posting_m) &&
           (!half_m || (divides(posting_m, half_m->x) && divides(posting_m, half_m->y)));
  }
};

/// Throws UsageError where there is no extent to choose from.
void require_extent(const PointOutline& outline, const std::string& config_name) {
  if (outline.extent_m() > 0) return;
  throw UsageError(config_name + ": the returns " +
                   (outline.count() == 0 ? "in the given area are none" : "lie on one point") +
                   ", from which no grid can be chosen: give resolution_m and half_width_m");
}

Choice choose(const DemSources& sources, const Given& given, const std::string& config_name) {
  const Area area{given.center_m, given.half_m.value_or(Area{}.half)};
  PointOutline outline = outline_of(sources, area);
  require_extent(outline, config_name);
  const Horizontal reach_m = outline.reach_m();
  if (given.resolution_m) return {*given.resolution_m, half_width(reach_m, *given.resolution_m)};
  PostingSearch search(std::move(outline));
  read_points(sources, area, [&](auto x_m, auto y_m) { search.mark(x_m, y_m); });
  const auto chosen = search.finest([&](double posting_m) { return given.allows(posting_m); });
  if (!chosen)
    throw UsageError(config_name + ": no posting of 1, 2 or 5 x 10^k m leaves at most " +
                     percent_text(kMaxEmptyShare) + " of the bins between the points empty and divides " +
                     (given.half_m ? kHalfWidth : "center_m") + ": give resolution_m, or another " +
                     (given.half_m ? kHalfWidth : "center_m"));
  const double posting_m = chosen->posting.metres();
  const Horizontal half_m = given.half_m.value_or(half_width(reach_m, posting_m));
  require_possible_size(half_m, posting_m, config_name);
  return {posting_m, half_m, chosen->bins};
}

std::string sentence(const Choice& choice, const Given& given) {
  const std::string half = json_of(choice.half_m).dump();
  const std::string width =
      std::string(kHalfWidth) + " " + half + (given.half_m ? "" : ", the extent of the points");
  const std::string posting =
      std::string(kResolution) + " " + number_text(choice.resolution_m) +
      (choice.bins ? ", the finest of 1, 2, 5 x 10^k m that leaves at most " + percent_text(kMaxEmptyShare) +
                         " of the bins between them empty (" + percent_text(choice.bins->empty_share()) + ")"
                   : "");
  return "no complete grid is given: " + width + "; " + posting;
}

}  // namespace

std::optional<std::string> complete_grid(nlohmann::json& config, const DemSources& sources,
                                         const std::string& config_name) {
  Given given;
  if (config.contains(kResolution)) {
    if (!config[kResolution].is_number()) return std::nullopt;
    given.resolution_m = config[kResolution].get<double>();
  }
  if (config.contains(kHalfWidth)) given.half_m = numbers_of(config[kHalfWidth]);
  if (config.contains("center_m")) given.center_m = numbers_of(config["center_m"]).value_or(Horizontal{});
  const bool is_complete = given.resolution_m && config.contains(kHalfWidth);
  const bool is_valid =
      (!given.resolution_m || *given.resolution_m > 0) &&
      (given.half_m ? given.half_m->x > 0 && given.half_m->y > 0 : !config.contains(kHalfWidth));
  if (is_complete || !is_valid || sources.scans.empty() || !are_imported(sources.scans)) return std::nullopt;
  const Choice choice = choose(sources, given, config_name);
  config[kResolution] = choice.resolution_m;
  if (!given.half_m) config[kHalfWidth] = json_of(choice.half_m);
  return sentence(choice, given);
}

std::optional<std::string> posting_advice(const GridSpec& grid, const DemSources& sources) {
  if (!are_imported(sources.scans)) return std::nullopt;
  const auto middle = [&](std::int64_t first, std::int64_t count) {
    return (static_cast<double>(first) + static_cast<double>(count - 1) / 2) * grid.resolution_m;
  };
  const Area area{{middle(grid.first_col, grid.cols), middle(grid.first_row, grid.rows)},
                  {static_cast<double>(grid.cols) / 2 * grid.resolution_m,
                   static_cast<double>(grid.rows) / 2 * grid.resolution_m}};
  PointOutline outline = outline_of(sources, area);
  if (outline.extent_m() == 0) return std::nullopt;
  const std::vector<Horizontal> hull = outline.hull();
  PostingSearch search(std::move(outline));
  CellSet filled;
  read_points(sources, area, [&](auto x_m, auto y_m) {
    search.mark(x_m, y_m);
    const GridSpec bins{.resolution_m = grid.resolution_m};
    for (std::size_t i = 0; i < x_m.size(); ++i) filled.insert(bins.bin_of(x_m[i], y_m[i]));
  });
  if (count_hull_bins(hull, grid.resolution_m, filled).empty_share() <= kPoorShare) return std::nullopt;
  const auto chosen = search.finest([](double) { return true; });
  if (!chosen) return std::nullopt;
  return "more than half of the bins between the points are empty: resolution_m " +
         number_text(chosen->posting.metres()) + " would leave at most " + percent_text(kMaxEmptyShare) +
         " empty";
}

}  // namespace landfall
