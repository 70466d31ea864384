// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D34, D76
#include "scanner/line_search.h"

#include "base/parameter_check.h"

namespace landfall {
namespace {

/// Item i of count, spread evenly over -half_width_m .. half_width_m; the middle for a single item.
double spread(double half_width_m, std::int64_t i, std::int64_t count) {
  if (count == 1) return 0;
  return -half_width_m + 2 * half_width_m * static_cast<double>(i) / static_cast<double>(count - 1);
}

}  // namespace

LineSearch::LineSearch(const LineSearchParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  check_raster(order());
  require_positive({"", "half_width_m"}, parameters.half_width_m);
}

RasterOrder LineSearch::order() const {
  const LineSearchParameters& p = parameters_;
  return {p.rows, p.columns, p.direction, p.at_end};
}

std::optional<Point<DemFrame>> LineSearch::ground_aim(const PulseTime& pulse) const {
  const LineSearchParameters& p = parameters_;
  const auto position = raster_position(order(), pulse.pulse);
  if (!position) return std::nullopt;
  const bool steps = !p.ramped || p.rows == 1;
  const double down = steps ? spread(p.half_width_m, position->row, p.rows)
                            : spread(p.half_width_m, position->step, raster_steps(order()));
  return Point<DemFrame>{{spread(p.half_width_m, position->column, p.columns), -down, 0}};
}

std::optional<PatternJump> LineSearch::last_jump(const PulseTime& pulse) const {
  if (raster_steps(order()) == 1) return std::nullopt;
  return jump_to_piece(pulse, parameters_.columns);
}

std::optional<std::int64_t> LineSearch::pulse_limit() const {
  if (parameters_.at_end == AtEnd::wrap) return std::nullopt;
  return raster_steps(order());
}

}  // namespace landfall
