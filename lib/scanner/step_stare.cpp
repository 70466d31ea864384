// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D78
#include "scanner/step_stare.h"

#include "base/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxPulsesPerStep = 1 << 20;

/// The centre of the i-th of `count` equal pieces of -half_width_m .. half_width_m.
double center(double half_width_m, std::int64_t i, int count) {
  return half_width_m * (static_cast<double>(2 * i + 1 - count) / count);
}

}  // namespace

StepStare::StepStare(const StepStareParameters& parameters)
    : Pattern(parameters.compensated), parameters_(parameters) {
  const StepStareParameters& p = parameters;
  check_raster(order());
  require_positive({"", "half_width_m"}, p.half_width_m);
  require(p.pulses_per_step >= 1 && p.pulses_per_step <= kMaxPulsesPerStep, {"", "pulses_per_step"},
          p.pulses_per_step, "in 1..1048576");
}

RasterOrder StepStare::order() const {
  const StepStareParameters& p = parameters_;
  return {p.rows, p.columns, p.direction, p.at_end};
}

std::optional<Point<DemFrame>> StepStare::ground_aim(const PulseTime& pulse) const {
  const StepStareParameters& p = parameters_;
  const auto position = raster_position(order(), pulse.pulse / p.pulses_per_step);
  if (!position) return std::nullopt;
  return Point<DemFrame>{{center(p.half_width_m, position->column, p.columns),
                          -center(p.half_width_m, position->row, p.rows), 0}};
}

std::optional<PatternJump> StepStare::last_jump(const PulseTime& pulse) const {
  if (raster_steps(order()) == 1) return std::nullopt;
  return jump_to_piece(pulse, parameters_.pulses_per_step);
}

std::optional<std::int64_t> StepStare::pulse_limit() const {
  if (parameters_.at_end == AtEnd::wrap) return std::nullopt;
  return raster_steps(order()) * parameters_.pulses_per_step;
}

}  // namespace landfall
