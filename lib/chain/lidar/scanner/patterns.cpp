// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D34, D76, D77, D78, D79
#include "chain/lidar/scanner/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/numerics/portable_math.h"
#include "base/text/number_table.h"
#include "base/text/number_text.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxLines = 1 << 20;

/// The order in which the positions of a raster are visited: line by line from the top.
struct RasterOrder {
  int rows = 1;     ///< 1 .. 2^20
  int columns = 1;  ///< 1 .. 2^20
  LineDirection direction = LineDirection::unidirectional;
  AtEnd at_end = AtEnd::wrap;
};

/// The position in a raster at one step.
struct RasterPosition {
  std::int64_t row = 0;     ///< counted from the top
  std::int64_t column = 0;  ///< counted from the left
  std::int64_t step = 0;    ///< in this pass over the raster
};

template <class Parameters>
RasterOrder order_of(const Parameters& p) {
  return {p.rows, p.columns, p.direction, p.at_end};
}

/// Throws UsageError, naming the pattern's key and the bound, where rows or columns is out of range.
void check_raster(const RasterOrder& order) {
  require(order.rows >= 1 && order.rows <= kMaxLines, {"", "rows"}, order.rows, "in 1..1048576");
  require(order.columns >= 1 && order.columns <= kMaxLines, {"", "columns"}, order.columns, "in 1..1048576");
}

/// Positions in one pass.
std::int64_t raster_steps(const RasterOrder& order) { return std::int64_t{order.rows} * order.columns; }

/// The position at a step >= 0, counted over all passes; empty past the end of a raster that stops.
std::optional<RasterPosition> raster_position(const RasterOrder& order, std::int64_t step) {
  const std::int64_t count = raster_steps(order);
  if (order.at_end == AtEnd::stop && step >= count) return std::nullopt;
  const std::int64_t in_pass = step % count;
  const std::int64_t row = in_pass / order.columns;
  const std::int64_t column = in_pass % order.columns;
  const bool backwards = order.direction == LineDirection::boustrophedon && row % 2 == 1;
  return RasterPosition{row, backwards ? order.columns - 1 - column : column, in_pass};
}

/// The last jump of a pattern that jumps after every `length` pulses, to a new line or step; empty before the
/// first jump.
std::optional<PatternJump> jump_to_piece(const PulseTime& pulse, std::int64_t length) {
  const std::int64_t first = pulse.pulse - pulse.pulse % length;
  if (first == 0) return std::nullopt;
  const double interval_s = pulse.since_start_s / static_cast<double>(pulse.pulse);
  return PatternJump{static_cast<double>(pulse.pulse - first) * interval_s,
                     {first - 1, static_cast<double>(first - 1) * interval_s}};
}

/// Item i of count, spread evenly over -half_width_m .. half_width_m; the middle for a single item.
double spread(double half_width_m, std::int64_t i, std::int64_t count) {
  if (count == 1) return 0;
  return -half_width_m + 2 * half_width_m * static_cast<double>(i) / static_cast<double>(count - 1);
}

constexpr int kMaxPulsesPerStep = 1 << 20;

/// The centre of the i-th of `count` equal pieces of -half_width_m .. half_width_m.
double center(double half_width_m, std::int64_t i, int count) {
  return half_width_m * (static_cast<double>(2 * i + 1 - count) / count);
}

/// The fraction of the way outwards: 0 .. 1 and back again in every two periods.
double share_of_way(double periods) {
  const double in_cycle = periods - 2 * std::floor(periods / 2);
  return in_cycle <= 1 ? in_cycle : 2 - in_cycle;
}

constexpr double kTableSlack_s = 1e-9;
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

LineSearch::LineSearch(const LineSearchParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  check_raster(order_of(parameters));
  require_positive({"", "half_width_m"}, parameters.half_width_m);
}

std::optional<Point<DemFrame>> LineSearch::aim_point(const PulseTime& pulse) const {
  const LineSearchParameters& p = parameters_;
  const auto position = raster_position(order_of(p), pulse.pulse);
  if (!position) return std::nullopt;
  const bool steps = !p.ramped || p.rows == 1;
  const double down = steps ? spread(p.half_width_m, position->row, p.rows)
                            : spread(p.half_width_m, position->step, raster_steps(order_of(parameters_)));
  return Point<DemFrame>{{spread(p.half_width_m, position->column, p.columns), -down, 0}};
}

std::optional<PatternJump> LineSearch::last_jump(const PulseTime& pulse) const {
  if (raster_steps(order_of(parameters_)) == 1) return std::nullopt;
  return jump_to_piece(pulse, parameters_.columns);
}

std::optional<std::int64_t> LineSearch::pulse_limit() const {
  if (parameters_.at_end == AtEnd::wrap) return std::nullopt;
  return raster_steps(order_of(parameters_));
}

StepStare::StepStare(const StepStareParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  const StepStareParameters& p = parameters;
  check_raster(order_of(parameters));
  require_positive({"", "half_width_m"}, p.half_width_m);
  require(p.pulses_per_step >= 1 && p.pulses_per_step <= kMaxPulsesPerStep, {"", "pulses_per_step"},
          p.pulses_per_step, "in 1..1048576");
}

std::optional<Point<DemFrame>> StepStare::aim_point(const PulseTime& pulse) const {
  const StepStareParameters& p = parameters_;
  const auto position = raster_position(order_of(p), pulse.pulse / p.pulses_per_step);
  if (!position) return std::nullopt;
  return Point<DemFrame>{{center(p.half_width_m, position->column, p.columns),
                          -center(p.half_width_m, position->row, p.rows), 0}};
}

std::optional<PatternJump> StepStare::last_jump(const PulseTime& pulse) const {
  if (raster_steps(order_of(parameters_)) == 1) return std::nullopt;
  return jump_to_piece(pulse, parameters_.pulses_per_step);
}

std::optional<std::int64_t> StepStare::pulse_limit() const {
  if (parameters_.at_end == AtEnd::wrap) return std::nullopt;
  return raster_steps(order_of(parameters_)) * parameters_.pulses_per_step;
}

Stare::Stare(const StareParameters& parameters) : Pattern(parameters.compensated), parameters_(parameters) {
  for (const double value : parameters.aim_m) require_finite({"", "aim_m"}, value);
}

std::optional<Point<DemFrame>> Stare::aim_point(const PulseTime& /*pulse*/) const {
  return Point<DemFrame>{{parameters_.aim_m[0], parameters_.aim_m[1], 0}};
}

Spiral::Spiral(const SpiralParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  const SpiralParameters& p = parameters;
  require_positive({"", "radius_m"}, p.radius_m);
  require_positive({"", "pitch_m"}, p.pitch_m);
  require(p.inner_radius_m >= 0 && p.inner_radius_m < p.radius_m, {"", "inner_radius_m"}, p.inner_radius_m,
          ">= 0 and below radius_m");
  require_positive({"", "period_s"}, p.period_s);
}

std::optional<Point<DemFrame>> Spiral::aim_point(const PulseTime& pulse) const {
  const SpiralParameters& p = parameters_;
  const double share = share_of_way(pulse.since_start_s / p.period_s);
  const double outward = p.direction == SpiralDirection::outward ? share : 1 - share;
  const double inner = p.inner_radius_m * p.inner_radius_m;
  const double radius = std::sqrt(inner + (p.radius_m * p.radius_m - inner) * outward);
  const double azimuth = 2 * std::numbers::pi * (radius / p.pitch_m);
  return Point<DemFrame>{{radius * portable::cos(azimuth), radius * portable::sin(azimuth), 0}};
}

Rosette::Rosette(const RosetteParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  require_positive({"", "radius_m"}, parameters.radius_m);
  for (const double rate : parameters.rates_hz) require_finite({"", "rates_hz"}, rate);
  for (const double phase : parameters.phases_rad) require_finite({"", "phases_deg"}, phase);
}

std::optional<Point<DemFrame>> Rosette::aim_point(const PulseTime& pulse) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < 2; ++i) {
    const double angle =
        2 * std::numbers::pi * (parameters_.rates_hz[i] * pulse.since_start_s) + parameters_.phases_rad[i];
    sum += Eigen::Vector3d(portable::cos(angle), portable::sin(angle), 0);
  }
  return Point<DemFrame>{parameters_.radius_m / 2 * sum};
}

Lissajous::Lissajous(const LissajousParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  for (const double half : parameters.half_width_m) require_positive({"", "half_width_m"}, half);
  for (const double rate : parameters.rates_hz) require_not_negative({"", "rates_hz"}, rate);
  require_finite({"", "phase_deg"}, parameters.phase_rad);
}

std::optional<Point<DemFrame>> Lissajous::aim_point(const PulseTime& pulse) const {
  const auto& [width_x, width_y] = parameters_.half_width_m;
  const auto& [rate_x, rate_y] = parameters_.rates_hz;
  const double turn = 2 * std::numbers::pi;
  return Point<DemFrame>{
      {width_x * portable::sin(turn * (rate_x * pulse.since_start_s) + parameters_.phase_rad),
       width_y * portable::sin(turn * (rate_y * pulse.since_start_s)), 0}};
}

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

std::optional<Point<DemFrame>> TablePattern::aim_point(const PulseTime& pulse) const {
  const std::vector<AimSample>& samples = parameters_.samples;
  const double end_s = samples.back().t_s;
  double t = pulse.since_start_s;
  if (parameters_.at_end == AtTableEnd::wrap) t = std::fmod(t, end_s);
  if (parameters_.at_end == AtTableEnd::stop && t > end_s + kTableSlack_s) return std::nullopt;
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
