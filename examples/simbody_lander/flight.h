// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>

#include "control.h"
#include "navigation.h"

namespace lander {

struct FlightPlan {
  Design design;
  SensorErrors errors;
  Controller::Gains gains;
  Actuators::Limits limits;
  std::uint64_t seed = 1;
  double period_s = 0.01;       ///< of controller and inertial sensors
  int periods_per_update = 10;  ///< of velocimeter and altimeter
  Start start{{{-14, 9, 900}, {1.5, -1, -30}, Quaterniond::Identity(), {0, 0, 0}},
              {{0.06, 0.10}, {0.05, 0.08}},  // the propellant still swings after the braking burn
              0};
};

/// The poses at a time within a period.
struct PoseSample {
  BusState truth;
  BusState estimate;   ///< from the inertial measurements of the period
  BusState predicted;  ///< known in advance, from those of the period before: what a mirror can be aimed by
};

/// The lander, its sensors, its filter and its controller in a closed loop.
class Flight {
 public:
  /// The range of the altimeter: from a point along a unit vector, NaN if there is none.
  using Altimeter = std::function<double(const Vector3d& origin_m, const Vector3d& direction)>;

  Flight(const FlightPlan& plan, Altimeter altimeter);

  /// Advances by one period; `times_s` are increasing and within [t_s(), t_s() + period).
  std::vector<PoseSample> advance(std::span<const double> times_s = {});

  /// From now on: see Controller.
  void land_at(const Vector3d& site_m) { controller_.land_at(site_m); }

  [[nodiscard]] double t_s() const { return static_cast<double>(periods_) * plan_.period_s; }
  [[nodiscard]] const Lander& body() const { return lander_; }
  [[nodiscard]] const NavigationFilter& filter() const { return filter_; }
  [[nodiscard]] const Controls& controls() const { return controls_; }

 private:
  void navigate(const Increment& measured);

  FlightPlan plan_;
  Altimeter altimeter_;
  Lander lander_;
  Sensors sensors_;
  NavigationFilter filter_;
  Controller controller_;
  Actuators actuators_;
  Controls controls_;
  Increment last_;
  std::int64_t periods_ = 0;
};

}  // namespace lander
