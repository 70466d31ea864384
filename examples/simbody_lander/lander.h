// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D334
#pragma once

#include <Eigen/Geometry>
#include <memory>
#include <vector>

/// The motion of a lander with legs and swinging propellant, integrated by Simbody. This header and all units
/// but lander.cpp do not see Simbody. Frames are landfall's: D the map (z up), B the bus; SI units.
namespace lander {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// A rigid bus with its origin at its centre of mass, legs, and a pendulum per tank. Round numbers for a
/// Europa lander, not those of a design.
struct Design {
  double gravity_mps2 = 1.315;
  double bus_kg = 400;  ///< with the propellant that does not swing
  Vector3d bus_inertia_kgm2{160, 200, 240};

  /// Slender rods, each on a hinge with a spring and a damper, at equal angles around z.
  struct {
    int count = 4;
    double mass_kg = 12;
    double length_m = 1.2;
    double hinge_radius_m = 0.8;  ///< of the hinges from the bus's axis
    double hinge_z_m = -0.3;
    double droop_rad = 0.7;   ///< below the horizontal, with the spring at rest
    double frequency_hz = 3;  ///< of a leg on a fixed bus, without gravity
    double damping_ratio = 0.03;
  } legs;

  /// Two cylindrical tanks beside the bus's axis, at x = +offset_m and -offset_m. The part of the propellant
  /// that swings is a point mass on a massless rod (docs/reference/decisions.md, D334).
  struct {
    double propellant_kg = 150;  ///< of each tank
    double radius_m = 0.4;
    double fill_height_m = 0.5;
    double offset_m = 0.7;
    double hinge_z_m = 0.5;
    double damping_ratio = 0.01;
    bool swing = true;  ///< if false, the pendulums are locked
  } tanks;

  [[nodiscard]] double slosh_kg() const;  ///< the mass of one pendulum
  [[nodiscard]] double rod_m() const;     ///< the length of its rod
  [[nodiscard]] double total_kg() const;
  /// The height of the bus's origin above the feet, with the springs at rest.
  [[nodiscard]] double standing_m() const;
};

/// The bus: its origin and the velocity of that in D; D <- B; the angular rate in B.
struct BusState {
  Vector3d position_m{0, 0, 0};
  Vector3d velocity_mps{0, 0, 0};
  Quaterniond attitude{1, 0, 0, 0};
  Vector3d rate_radps{0, 0, 0};
};

struct Start {
  BusState bus;
  std::vector<Vector2d> slosh_rad{{0, 0}, {0, 0}};  ///< rotation of each rod about x_B, then about its own y
  double leg_rad = 0;                               ///< rotation of all legs from the springs' rest
};

/// The engine acts along z_B through the origin of B, the thrusters as a couple. Constant in B until changed.
struct Controls {
  double thrust_n = 0;
  Vector3d torque_nm{0, 0, 0};
};

/// One rigid body of the tree, for checks: everything in D, inertia about the centre of mass.
struct BodyMotion {
  double mass_kg = 0;
  Matrix3d inertia_kgm2;
  Vector3d centre_m;
  Vector3d velocity_mps;
  Vector3d rate_radps;
};

class Lander {
 public:
  explicit Lander(const Design& design, const Start& start = {});
  ~Lander();
  Lander(const Lander&) = delete;
  Lander& operator=(const Lander&) = delete;

  void set(const Controls& controls);
  /// Integrates to exactly this time, without interpolation.
  void advance_to(double t_s);

  [[nodiscard]] double t_s() const;
  [[nodiscard]] BusState bus() const;
  [[nodiscard]] std::vector<Vector2d> slosh_rad() const;
  [[nodiscard]] std::vector<double> legs_rad() const;
  /// The bus, the legs, then the pendulums.
  [[nodiscard]] std::vector<BodyMotion> bodies() const;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace lander
