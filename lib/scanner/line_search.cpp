// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/line_search.h"

#include "base/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxLines = 1 << 20;

/// Item i of count, spread evenly over -half_width_m .. half_width_m; the middle where there is but one.
double spread(double half_width_m, std::int64_t i, int count) {
  if (count == 1) return 0;
  return -half_width_m + 2 * half_width_m * static_cast<double>(i) / (count - 1);
}

}  // namespace

LineSearch::LineSearch(const LineSearchParameters& parameters) : parameters_(parameters) {
  const LineSearchParameters& p = parameters;
  require(p.rows >= 1 && p.rows <= kMaxLines, {"scanner/pattern", "rows"}, p.rows, "in 1..1048576");
  require(p.columns >= 1 && p.columns <= kMaxLines, {"scanner/pattern", "columns"}, p.columns,
          "in 1..1048576");
  require_positive({"scanner/pattern", "half_width_m"}, p.half_width_m);
}

std::optional<Point<DemFrame>> LineSearch::ground_aim(const PulseTime& pulse) const {
  const LineSearchParameters& p = parameters_;
  const std::int64_t count = std::int64_t{p.rows} * p.columns;
  if (p.at_end == AtEnd::stop && pulse.pulse >= count) return std::nullopt;
  const std::int64_t line = pulse.pulse % count / p.columns;
  const std::int64_t place = pulse.pulse % p.columns;
  const bool backwards = p.direction == LineDirection::boustrophedon && line % 2 == 1;
  return Point<DemFrame>{{spread(p.half_width_m, backwards ? p.columns - 1 - place : place, p.columns),
                          -spread(p.half_width_m, line, p.rows), 0}};
}

std::optional<std::int64_t> LineSearch::pulse_limit() const {
  if (parameters_.at_end == AtEnd::wrap) return std::nullopt;
  return std::int64_t{parameters_.rows} * parameters_.columns;
}

}  // namespace landfall
