// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/table_pattern.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/number_text.h"

namespace landfall {
namespace {

constexpr double kTimeSlack_s = 1e-9;
constexpr double kClosed_m = 1e-3;

bool is_finite(const AimSample& s) {
  return std::isfinite(s.t_s) && std::isfinite(s.x_m) && std::isfinite(s.y_m);
}

/// Rows of a table that can be refused by its name.
struct NamedRows {
  std::span<const AimSample> samples;
  const std::string& name;

  [[noreturn]] void refuse(std::size_t index, const std::string& what) const {
    throw FormatError(name + ": row " + std::to_string(index + 1) + ": " + what);
  }
};

void check_rows(const NamedRows& rows) {
  const auto samples = rows.samples;
  if (samples.size() < 2)
    throw FormatError(rows.name + ": " + std::to_string(samples.size()) + " rows, at least 2 are needed");
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (!is_finite(samples[i])) rows.refuse(i, "a value is not finite");
    if (i > 0 && !(samples[i].t_s > samples[i - 1].t_s))
      rows.refuse(i, "t_s does not exceed that of the row before");
  }
  if (samples.front().t_s != 0)
    rows.refuse(0,
                "t_s is " + number_text(samples.front().t_s) + ", not 0: times count from the first pulse");
}

void check_closed(const NamedRows& rows) {
  const AimSample& first = rows.samples.front();
  const AimSample& last = rows.samples.back();
  const double gap_m = std::hypot(last.x_m - first.x_m, last.y_m - first.y_m);
  if (gap_m <= kClosed_m) return;
  rows.refuse(rows.samples.size() - 1,
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
    : parameters_(std::move(parameters)) {
  const NamedRows rows{parameters_.samples, name};
  check_rows(rows);
  if (parameters_.at_end == AtTableEnd::wrap) check_closed(rows);
}

std::optional<Point<DemFrame>> TablePattern::ground_aim(const PulseTime& pulse) const {
  const std::vector<AimSample>& samples = parameters_.samples;
  const double end_s = samples.back().t_s;
  double t = pulse.since_start_s;
  if (parameters_.at_end == AtTableEnd::wrap) t = std::fmod(t, end_s);
  if (parameters_.at_end == AtTableEnd::stop && t > end_s + kTimeSlack_s) return std::nullopt;
  t = std::min(t, end_s);
  // The piece that begins at or before t; the last time belongs to the last piece.
  const auto next = std::upper_bound(samples.begin() + 1, samples.end() - 1, t,
                                     [](double time, const AimSample& s) { return time < s.t_s; });
  const AimSample& a = *(next - 1);
  const AimSample& b = *next;
  const double u = (t - a.t_s) / (b.t_s - a.t_s);
  // Written from both ends, so that every row is met exactly.
  return Point<DemFrame>{{(1 - u) * a.x_m + u * b.x_m, (1 - u) * a.y_m + u * b.y_m, 0}};
}

}  // namespace landfall
