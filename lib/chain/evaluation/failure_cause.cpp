// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D469
#include "chain/evaluation/failure_cause.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <utility>

#include "base/numerics/non_finite.h"
#include "base/numerics/portable_math.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "chain/evaluation/fail_flag.h"

namespace landfall {
namespace {

/// The tilt of the errors over the window must be known this well, as a share of the whole displacement.
constexpr double kMaxTiltError = 0.1;

/// The parts of the errors of a bin.
struct BinErrors {
  BinIndex bin;
  double x, y, z;             ///< e
  double offset_x, offset_y;  ///< mean estimated position of the returns from the centre; 0 if not known
  double rest_z;              ///< e_z without slope times offset
  double count;               ///< NaN if not known
};

/// How much higher the terrain is at an offset from a bin's centre: bilinear between the elevations of the
/// bins there, or beyond those on the other side.
double rise_at(const Grid<double>& z, BinIndex bin, double x, double y) {
  const double here = z.at(bin);
  const auto elevation = [&](std::int64_t up, std::int64_t right) {
    const BinIndex other{bin.row + up, bin.col + right};
    return z.spec().contains(other) ? z.at(other) : kNan;
  };
  const auto beside = [&](std::int64_t up, std::int64_t right) {
    if (const double there = elevation(up, right); std::isfinite(there)) return there - here;
    const double behind = elevation(-up, -right);
    return std::isfinite(behind) ? here - behind : 0.0;
  };
  const std::int64_t up = y < 0 ? -1 : 1;
  const std::int64_t right = x < 0 ? -1 : 1;
  const double p = std::abs(x) / z.spec().resolution_m;
  const double q = std::abs(y) / z.spec().resolution_m;
  const double along_x = beside(0, right);
  const double along_y = beside(up, 0);
  const double corner = elevation(up, right) - here;
  return p * (1 - q) * along_x + (1 - p) * q * along_y +
         p * q * (std::isfinite(corner) ? corner : along_x + along_y);
}

BinErrors errors_of_bin(const ErrorsAbout& errors, BinIndex bin) {
  const GridSpec& spec = errors.z.spec();
  BinErrors found{bin,
                  errors.x.at(bin),
                  errors.y.at(bin),
                  errors.z.at(bin),
                  0,
                  0,
                  errors.z.at(bin),
                  errors.count ? errors.count->at(bin) : kNan};
  if (!errors.positions) return found;
  found.offset_x = errors.positions->x.at(bin) - spec.x(bin.col);
  found.offset_y = errors.positions->y.at(bin) - spec.y(bin.row);
  if (!std::isfinite(found.offset_x) || !std::isfinite(found.offset_y)) found.offset_x = found.offset_y = 0;
  found.rest_z = found.z + rise_at(errors.positions->z_true, bin, found.offset_x, found.offset_y);
  return found;
}

bool has_elevation(const ErrorsAbout& errors, BinIndex bin) { return std::isfinite(errors.z.at(bin)); }

/// The bins with an elevation: those of the footprint, or all of the window.
std::vector<BinErrors> bins_of(const ErrorsAbout& errors, const FootprintAbout* about) {
  std::vector<BinErrors> all;
  const GridSpec& spec = errors.z.spec();
  const std::int64_t half = about == nullptr ? 0 : about->footprint.half_bins();
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const std::int64_t up = about == nullptr ? 0 : row - about->bin.row;
      const bool is_inside =
          about == nullptr ||
          (std::abs(up) <= half && std::abs(col - about->bin.col) <= about->footprint.half_width(up));
      if (is_inside && has_elevation(errors, {row, col})) all.push_back(errors_of_bin(errors, {row, col}));
    }
  return all;
}

template <class Of>
double mean_of(const std::vector<BinErrors>& bins, const Of& of) {
  double sum = 0;
  for (const BinErrors& bin : bins) sum += of(bin);
  return sum / static_cast<double>(bins.size());
}

/// Mean square about the mean.
template <class Of>
double variance_of(const std::vector<BinErrors>& bins, const Of& of) {
  const double mean = mean_of(bins, of);
  return mean_of(bins, [&](const BinErrors& bin) { return (of(bin) - mean) * (of(bin) - mean); });
}

/// The share of a variance that is not in the rest; none without a variance.
std::optional<double> explained(double variance, double rest) {
  return variance > 0 ? std::optional(std::max(0.0, 1 - rest / variance)) : std::nullopt;
}

/// The correlation of the rest of the elevation errors of bins that share an edge.
std::optional<double> neighbour_correlation(const std::vector<BinErrors>& bins) {
  const auto rest = [](const BinErrors& bin) { return bin.rest_z; };
  const double mean = mean_of(bins, rest);
  const double variance = variance_of(bins, rest);
  std::map<std::pair<std::int64_t, std::int64_t>, double> at;
  for (const BinErrors& bin : bins) at[{bin.bin.row, bin.bin.col}] = bin.rest_z - mean;
  double sum = 0;
  int pairs = 0;
  for (const auto& [place, value] : at)
    for (const auto& [row, col] :
         {std::pair(place.first + 1, place.second), std::pair(place.first, place.second + 1)})
      if (const auto other = at.find({row, col}); other != at.end()) {
        sum += value * other->second;
        ++pairs;
      }
  if (pairs == 0 || !(variance > 0)) return std::nullopt;
  return sum / pairs / variance;
}

/// Elevation errors shrink as one over the square root of the returns: the number of them in each bin with
/// which the footprint would pass. `rest_frac`: the share of the squared error that is noise.
std::optional<double> needed_returns(const std::vector<BinErrors>& bins, double share, double rest_frac) {
  const double inverse = mean_of(bins, [](const BinErrors& bin) { return 1 / bin.count; });
  if (!std::isfinite(inverse) || !std::isfinite(share)) return std::nullopt;
  return share * share * rest_frac / inverse;
}

void measure_relative(const std::vector<BinErrors>& bins, const ErrorsAbout& errors, double share,
                      const std::optional<LidarMotion>& motion, Measures& measures) {
  const auto set = [&](Measure measure, std::optional<double> value) {
    measures[static_cast<std::size_t>(measure)] = value;
  };
  const double rest = variance_of(bins, [](const BinErrors& bin) { return bin.rest_z; });
  const auto flank = explained(variance_of(bins, [](const BinErrors& bin) { return bin.z; }), rest);
  set(Measure::neighbour_correlation, neighbour_correlation(bins));
  if (!errors.positions) return;
  set(Measure::flank_frac, flank);
  set(Measure::needed_returns, needed_returns(bins, share, 1 - flank.value_or(0)));
  const auto x = [](const BinErrors& bin) { return bin.x - bin.offset_x; };
  const auto y = [](const BinErrors& bin) { return bin.y - bin.offset_y; };
  const double moved = variance_of(bins, x) + variance_of(bins, y);
  set(Measure::position_frac, explained(variance_of(bins, [](const BinErrors& bin) { return bin.x; }) +
                                            variance_of(bins, [](const BinErrors& bin) { return bin.y; }),
                                        moved));
  if (!motion) return;
  const double speed = portable::hypot(motion->velocity_mps[0], motion->velocity_mps[1]);
  if (speed > 0 && moved > 0)
    set(Measure::along_track_frac,
        variance_of(bins, [&](const BinErrors& bin) {
          return (x(bin) * motion->velocity_mps[0] + y(bin) * motion->velocity_mps[1]) / speed;
        }) / moved);
}

/// A displacement of the whole map, metres: x, y, z, and the change of z along x and y over a length of the
/// range.
using Displacement = std::array<double, 5>;

double dot(const Displacement& a, const Displacement& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// The share of a displacement that no combination of the models gives.
double misfit(const Displacement& found, std::vector<Displacement> models) {
  Displacement rest = found;
  for (std::size_t k = 0; k < models.size(); ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      const double along = dot(models[k], models[j]);
      for (std::size_t i = 0; i < rest.size(); ++i) models[k][i] -= along * models[j][i];
    }
    const double length = std::sqrt(dot(models[k], models[k]));
    for (double& value : models[k]) value = length > 0 ? value / length : 0;
    const double along = dot(rest, models[k]);
    for (std::size_t i = 0; i < rest.size(); ++i) rest[i] -= along * models[k][i];
  }
  return std::sqrt(dot(rest, rest) / dot(found, found));
}

/// The mean displacement of the window's bins, and the tilt of the elevation errors by least squares; none if
/// the tilt is not known well enough to tell a turn from a shift.
std::optional<Displacement> displacement_of(const std::vector<BinErrors>& bins, const GridSpec& spec,
                                            double range_m) {
  const auto x = [&](const BinErrors& bin) { return spec.x(bin.bin.col); };
  const auto y = [&](const BinErrors& bin) { return spec.y(bin.bin.row); };
  const auto z = [](const BinErrors& bin) { return bin.rest_z; };
  const double mean_x = mean_of(bins, x);
  const double mean_y = mean_of(bins, y);
  const double mean_z = mean_of(bins, z);
  const auto product = [&](const auto& a, double mean_a, const auto& b, double mean_b) {
    return mean_of(bins, [&](const BinErrors& bin) { return (a(bin) - mean_a) * (b(bin) - mean_b); });
  };
  const double xx = product(x, mean_x, x, mean_x), yy = product(y, mean_y, y, mean_y);
  const double xy = product(x, mean_x, y, mean_y);
  const double xz = product(x, mean_x, z, mean_z), yz = product(y, mean_y, z, mean_z);
  const double determinant = xx * yy - xy * xy;
  const double tilt_x = (xz * yy - yz * xy) / determinant;
  const double tilt_y = (yz * xx - xz * xy) / determinant;
  const double scatter = mean_of(bins, [&](const BinErrors& bin) {
    const double rest = z(bin) - mean_z - tilt_x * (x(bin) - mean_x) - tilt_y * (y(bin) - mean_y);
    return rest * rest;
  });
  const double tilt_error =
      std::sqrt(scatter * std::max(xx, yy) / determinant / static_cast<double>(bins.size()));
  const Displacement found = {mean_of(bins, [](const BinErrors& bin) { return bin.x - bin.offset_x; }),
                              mean_of(bins, [](const BinErrors& bin) { return bin.y - bin.offset_y; }),
                              mean_z, range_m * tilt_x, range_m * tilt_y};
  const bool is_known = range_m * tilt_error <= kMaxTiltError * std::sqrt(dot(found, found));
  return is_known ? std::optional(found) : std::nullopt;
}

/// The displacement by a small rotation of the lidar about itself: phi x r of the points at r from it, and
/// the tilt.
Displacement displaced_by_turn(const std::array<double, 3>& phi, const std::array<double, 3>& r,
                               double range_m) {
  return {phi[1] * r[2] - phi[2] * r[1], phi[2] * r[0] - phi[0] * r[2], phi[0] * r[1] - phi[1] * r[0],
          -range_m * phi[1], range_m * phi[0]};
}

void measure_absolute(const std::vector<BinErrors>& bins, const GridSpec& spec, const LidarMotion& motion,
                      Measures& measures) {
  const auto set = [&](Measure measure, double value) {
    measures[static_cast<std::size_t>(measure)] = value;
  };
  const std::array<double, 3> r = {
      mean_of(bins, [&](const BinErrors& bin) { return spec.x(bin.bin.col); }) - motion.position_m[0],
      mean_of(bins, [&](const BinErrors& bin) { return spec.y(bin.bin.row); }) - motion.position_m[1],
      -motion.position_m[2]};
  const double range_m = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
  const auto found = displacement_of(bins, spec, range_m);
  if (!found) return;
  set(Measure::turn_misfit,
      misfit(*found, {displaced_by_turn({1, 0, 0}, r, range_m), displaced_by_turn({0, 1, 0}, r, range_m)}));
  Displacement by_clock = displaced_by_turn(motion.rate_radps, r, range_m);
  for (std::size_t i = 0; i < 3; ++i) by_clock[i] += motion.velocity_mps[i];
  set(Measure::clock_misfit, misfit(*found, {by_clock}));
  set(Measure::shift_misfit, misfit(*found, {{1, 0, 0, 0, 0}, {0, 1, 0, 0, 0}, {0, 0, 1, 0, 0}}));
}

/// Whether a bin lies within the scan, and is empty.
enum class Cover : std::int8_t { full, empty, beyond };

/// A bin lies within the scan if it has bins with an elevation on both sides in its row or in its column.
Grid<Cover> cover_of(const ErrorsAbout& errors) {
  const GridSpec& spec = errors.z.spec();
  struct Span {
    std::int64_t first = std::numeric_limits<std::int64_t>::max(), last = -1;
    void add(std::int64_t index) {
      first = std::min(first, index);
      last = std::max(last, index);
    }
    [[nodiscard]] bool holds(std::int64_t index) const { return first < index && index < last; }
  };
  std::vector<Span> rows(static_cast<std::size_t>(spec.rows));
  std::vector<Span> cols(static_cast<std::size_t>(spec.cols));
  Grid<Cover> cover(spec);
  const auto for_each_bin = [&](const auto& work) {
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col)
        work(BinIndex{row, col}, rows[static_cast<std::size_t>(row)], cols[static_cast<std::size_t>(col)]);
  };
  for_each_bin([&](BinIndex bin, Span& row, Span& col) {
    if (!has_elevation(errors, bin)) return;
    row.add(bin.col);
    col.add(bin.row);
  });
  for_each_bin([&](BinIndex bin, const Span& row, const Span& col) {
    if (!has_elevation(errors, bin))
      cover.at(bin) = row.holds(bin.col) || col.holds(bin.row) ? Cover::empty : Cover::beyond;
  });
  return cover;
}

/// The share of the variance of the empty bins of a scan that lies between parallel lines of bins in a
/// direction, less that which random bins give (adjusted R^2).
double line_share(const Grid<Cover>& cover, double angle_rad) {
  const GridSpec& spec = cover.spec();
  struct Line {
    double bins = 0, empty = 0;
  };
  std::map<std::int64_t, Line> lines;
  Line all;
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const Cover here = cover.at({row, col});
      if (here == Cover::beyond) continue;
      const double across = static_cast<double>(row) * portable::cos(angle_rad) -
                            static_cast<double>(col) * portable::sin(angle_rad);
      for (Line* const line : {&lines[std::llround(across)], &all}) {
        ++line->bins;
        line->empty += here == Cover::empty ? 1 : 0;
      }
    }
  const double mean = all.empty / all.bins;
  double between = 0;
  for (const auto& [index, line] : lines)
    between += line.bins * (line.empty / line.bins - mean) * (line.empty / line.bins - mean);
  const double total = all.bins * mean * (1 - mean);
  const auto free = static_cast<double>(lines.size()) - 1;
  if (!(total > 0) || all.bins <= free + 1) return 0;
  return 1 - (1 - between / total) * (all.bins - 1) / (all.bins - 1 - free);
}

void measure_coverage(const ErrorsAbout& errors, const FootprintAbout& about, Measures& measures) {
  const GridSpec& spec = errors.z.spec();
  const Grid<Cover> cover = cover_of(errors);
  double empty = 0, beyond = 0;
  const std::int64_t half = about.footprint.half_bins();
  for (std::int64_t up = -half; up <= half; ++up)
    for (std::int64_t right = -about.footprint.half_width(up); right <= about.footprint.half_width(up);
         ++right) {
      const BinIndex bin{about.bin.row + up, about.bin.col + right};
      if (!spec.contains(bin) || cover.at(bin) == Cover::full) continue;
      ++empty;
      beyond += cover.at(bin) == Cover::beyond ? 1 : 0;
    }
  if (empty == 0) return;
  measures[static_cast<std::size_t>(Measure::beyond_frac)] = beyond / empty;
  // A step of the angle moves the end of a line through the middle by one bin.
  const auto size = static_cast<double>(std::max(spec.rows, spec.cols));
  const auto steps = std::max<std::int64_t>(8, std::llround(std::numbers::pi / 4 * size));
  double largest = 0;
  for (std::int64_t step = 0; step < steps; ++step) {
    const double angle = std::numbers::pi / 2 * static_cast<double>(step) / static_cast<double>(steps);
    largest = std::max(largest, line_share(cover, angle) + line_share(cover, angle + std::numbers::pi / 2));
  }
  measures[static_cast<std::size_t>(Measure::line_frac)] = std::min(1.0, largest);
}

}  // namespace

std::array<double, 2> gradient_at(const Grid<double>& z, BinIndex bin) {
  const auto along = [&](BinIndex step) {
    const BinIndex ends[] = {{bin.row - step.row, bin.col - step.col},
                             {bin.row + step.row, bin.col + step.col}};
    double value[2] = {kNan, kNan};
    for (int k = 0; k < 2; ++k)
      if (z.spec().contains(ends[k])) value[k] = z.at(ends[k]);
    const double s = z.spec().resolution_m;
    if (std::isfinite(value[0]) && std::isfinite(value[1])) return (value[1] - value[0]) / (2 * s);
    if (std::isfinite(value[0])) return (z.at(bin) - value[0]) / s;
    return std::isfinite(value[1]) ? (value[1] - z.at(bin)) / s : 0.0;
  };
  return {along({0, 1}), along({1, 0})};
}

const char* name_of(Missed missed) {
  const auto bits = kMissedBits[static_cast<std::size_t>(missed)];
  return missed == Missed::coverage ? "coverage" : requirement_of(static_cast<FailFlag>(bits & -bits));
}

const char* words_of(Measure measure) {
  constexpr std::array<const char*, kMeasureCount> kWords = {
      "share of the squared elevation error that slope times position of the returns in a bin explains",
      "correlation of the elevation errors of neighbouring bins",
      "returns in each bin with which the footprint would pass",
      "share of the squared horizontal error that the position of the returns in a bin explains",
      "share of the squared displacement along the track",
      "share of the map's displacement that no turn of the lidar gives",
      "share of the map's displacement that no delay along the track gives",
      "share of the map's displacement that no shift gives",
      "share of the scatter of the empty bins that parallel lines explain",
      "share of the footprint's empty bins beyond the scan"};
  return kWords[static_cast<std::size_t>(measure)];
}

Measures measure_errors(const ErrorsAbout& errors, const FootprintAbout& about,
                        const std::optional<LidarMotion>& motion) {
  Measures measures;
  measure_coverage(errors, about, measures);
  const std::vector<BinErrors> bins = bins_of(errors, &about);
  if (bins.empty()) return measures;
  measure_relative(bins, errors, about.relative_share, motion, measures);
  if (motion) measure_absolute(bins_of(errors, nullptr), errors.z.spec(), *motion, measures);
  return measures;
}

bool holds(const CauseRule& rule, const Measures& measures) {
  const auto value = measures[static_cast<std::size_t>(rule.measure)];
  return value && (rule.at_least ? *value >= rule.bound : *value <= rule.bound);
}

std::vector<std::string> likely_causes(Missed missed, const Measures& measures) {
  std::vector<std::string> causes;
  for (const CauseRule& rule : kCauseRules)
    if (rule.missed == missed && (causes.empty() || causes.back() != rule.cause))
      causes.emplace_back(rule.cause);
  std::erase_if(causes, [&](const std::string& cause) {
    return std::ranges::any_of(kCauseRules, [&](const CauseRule& rule) {
      return rule.missed == missed && rule.cause == cause && !holds(rule, measures);
    });
  });
  return causes;
}

std::string cause_text(Missed missed, const Measures& measures) {
  const std::vector<std::string> likely = likely_causes(missed, measures);
  if (likely.empty()) return "unclear: no cause keeps all of its rules";
  if (likely.size() > 1) return "unclear: " + joined(likely, " and ") + " are alike here";
  std::string text = likely.front() + ", because ";
  const char* gap = "";
  for (const CauseRule& rule : kCauseRules) {
    if (rule.missed != missed || rule.cause != likely.front()) continue;
    text += std::string(std::exchange(gap, "; ")) + words_of(rule.measure) + ": " +
            short_number(*measures[static_cast<std::size_t>(rule.measure)]) + " (at " +
            (rule.at_least ? "least " : "most ") + short_number(rule.bound) + ")";
  }
  return text;
}

}  // namespace landfall
