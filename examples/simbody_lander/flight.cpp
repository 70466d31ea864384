// SPDX-License-Identifier: GPL-3.0-or-later
#include "flight.h"

#include <cmath>
#include <utility>

namespace lander {
namespace {

/// The engine carries the weight from the start.
Controls hover(const Design& design) { return {design.total_kg() * design.gravity_mps2, {0, 0, 0}}; }

}  // namespace

Flight::Flight(const FlightPlan& plan, Altimeter altimeter)
    : plan_(plan),
      altimeter_(std::move(altimeter)),
      lander_(plan.design, plan.start),
      sensors_(plan.errors, plan.design.gravity_mps2, plan.seed),
      filter_(plan.errors, plan.design.gravity_mps2, sensors_.first_estimate(plan.start.bus)),
      controller_(plan.gains, plan.design),
      actuators_(plan.limits, hover(plan.design)),
      controls_(hover(plan.design)) {
  lander_.set(controls_);
  last_.period_s = plan.period_s;
  last_.velocity_mps = Vector3d(0, 0, plan.design.gravity_mps2 * plan.period_s);
}

std::vector<PoseSample> Flight::advance(std::span<const double> times_s) {
  const BusState before = lander_.bus();
  std::vector<PoseSample> samples;
  for (const double t : times_s) {
    lander_.advance_to(t);
    samples.push_back({lander_.bus(), {}, filter_.after((t - t_s()) / plan_.period_s, last_)});
  }
  lander_.advance_to(static_cast<double>(periods_ + 1) * plan_.period_s);
  const Increment measured = sensors_.increment(before, lander_.bus(), plan_.period_s);
  for (std::size_t i = 0; i < samples.size(); ++i)
    samples[i].estimate = filter_.after((times_s[i] - t_s()) / plan_.period_s, measured);
  ++periods_;
  navigate(measured);
  controls_ = actuators_.follow(controller_.command(filter_.estimate()), plan_.period_s);
  lander_.set(controls_);
  return samples;
}

void Flight::navigate(const Increment& measured) {
  filter_.propagate(measured);
  last_ = measured;
  if (periods_ % plan_.periods_per_update != 0) return;
  const BusState truth = lander_.bus();
  filter_.update_velocity(sensors_.velocity_in_body(truth));
  const double range = altimeter_(truth.position_m, truth.attitude * -Vector3d::UnitZ());
  if (std::isfinite(range)) filter_.update_altitude(sensors_.altimeter(range));
}

}  // namespace lander
