// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D79
#include "scanner/table_pattern.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/number_text.h"
#include "base/portable_math.h"
#include "base/timed_rows.h"

namespace landfall {
namespace {

constexpr double kTimeSlack_s = 1e-9;
constexpr double kClosed_m = 1e-3;

void check_table(const TablePatternParameters& parameters, const std::string& name) {
  require_timed_rows<AimSample>(parameters.samples, name, [](const AimSample& s) {
    return std::isfinite(s.x_m) && std::isfinite(s.y_m);
  });
  const AimSample& first = parameters.samples.front();
  const AimSample& last = parameters.samples.back();
  if (first.t_s != 0)
    refuse_row(name, 0, "t_s is " + number_text(first.t_s) + ", not 0: times count from the first pulse");
  if (parameters.at_end != AtTableEnd::wrap) return;
  const double gap_m = portable::hypot(last.x_m - first.x_m, last.y_m - first.y_m);
  if (gap_m <= kClosed_m) return;
  refuse_row(name, parameters.samples.size() - 1,
             "ends " + number_text(gap_m) +
                 " m from the first row; a table that wraps must end within 0.001 m of it");
}

}  // namespace

const TableColumns& aim_columns() {
  static const TableColumns columns{{"t_s", "x_m", "y_m"}};
  return columns;
}

std::vector<AimSample> aim_samples(const NumberTable& table) {
  std::vector<AimSample> samples(table.row_count());
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i] = {table.column("t_s")[i], table.column("x_m")[i], table.column("y_m")[i]};
  return samples;
}

TablePattern::TablePattern(TablePatternParameters parameters, const std::string& name)
    : Pattern(parameters.compensated), parameters_(std::move(parameters)) {
  check_table(parameters_, name);
}

std::optional<Point<DemFrame>> TablePattern::ground_aim(const PulseTime& pulse) const {
  const std::vector<AimSample>& samples = parameters_.samples;
  const double end_s = samples.back().t_s;
  double t = pulse.since_start_s;
  if (parameters_.at_end == AtTableEnd::wrap) t = std::fmod(t, end_s);
  if (parameters_.at_end == AtTableEnd::stop && t > end_s + kTimeSlack_s) return std::nullopt;
  t = std::min(t, end_s);
  // The piece that begins at or before t. The last time belongs to the last piece.
  const auto next = std::upper_bound(samples.begin() + 1, samples.end() - 1, t,
                                     [](double time, const AimSample& s) { return time < s.t_s; });
  const AimSample& a = *(next - 1);
  const AimSample& b = *next;
  const double u = (t - a.t_s) / (b.t_s - a.t_s);
  // Interpolates from both ends, so that every row is reproduced exactly.
  return Point<DemFrame>{{(1 - u) * a.x_m + u * b.x_m, (1 - u) * a.y_m + u * b.y_m, 0}};
}

}  // namespace landfall
