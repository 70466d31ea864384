// SPDX-License-Identifier: GPL-3.0-or-later
#include "lander.h"

#include <Simbody.h>

#include <cmath>

namespace lander {
namespace {

using SimTK::MobilizedBody;
using SimTK::Vec3;

constexpr double kFirstLateralMode = 1.8412;  // zero of J1', the derivative of the Bessel function
constexpr double kAccuracy = 1e-10;

Vec3 to_simbody(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }
Vector3d to_eigen(const Vec3& v) { return {v[0], v[1], v[2]}; }

Matrix3d to_eigen(const SimTK::Mat33& m) {
  Matrix3d result;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) result(row, col) = m(row, col);
  return result;
}

/// The force of the engine and the couple of the thrusters; both turn with the bus.
class Thrusters : public SimTK::Force::Custom::Implementation {
 public:
  explicit Thrusters(SimTK::MobilizedBodyIndex bus, const SimTK::SimbodyMatterSubsystem& matter)
      : bus_(bus), matter_(matter) {}

  void calcForce(const SimTK::State& state, SimTK::Vector_<SimTK::SpatialVec>& body_forces,
                 SimTK::Vector_<Vec3>&, SimTK::Vector&) const override {
    const SimTK::Rotation& R_ground_bus = matter_.getMobilizedBody(bus_).getBodyRotation(state);
    body_forces[bus_] += SimTK::SpatialVec(R_ground_bus * to_simbody(controls.torque_nm),
                                           R_ground_bus * Vec3(0, 0, controls.thrust_n));
  }
  double calcPotentialEnergy(const SimTK::State&) const override { return 0; }

  Controls controls;

 private:
  SimTK::MobilizedBodyIndex bus_;
  const SimTK::SimbodyMatterSubsystem& matter_;
};

/// The hinge of a leg: x along the leg at rest, z the axis.
SimTK::Transform leg_hinge(const Design& design, int leg) {
  const double azimuth = 2 * SimTK::Pi * (leg + 0.5) / design.legs.count;
  const Vec3 outward(std::cos(azimuth), std::sin(azimuth), 0);
  const Vec3 along =
      std::cos(design.legs.droop_rad) * outward - std::sin(design.legs.droop_rad) * Vec3(0, 0, 1);
  const SimTK::Rotation frame(SimTK::UnitVec3(along), SimTK::XAxis, Vec3(0, 0, 1), SimTK::YAxis);
  return {frame, design.legs.hinge_radius_m * outward + Vec3(0, 0, design.legs.hinge_z_m)};
}

}  // namespace

double Design::slosh_kg() const {
  const double ratio = tanks.radius_m / tanks.fill_height_m;
  return tanks.propellant_kg * ratio / 2.2 * std::tanh(kFirstLateralMode / ratio);
}

double Design::rod_m() const {
  return tanks.radius_m /
         (kFirstLateralMode * std::tanh(kFirstLateralMode * tanks.fill_height_m / tanks.radius_m));
}

double Design::standing_m() const { return legs.length_m * std::sin(legs.droop_rad) - legs.hinge_z_m; }

double Design::total_kg() const { return bus_kg + legs.count * legs.mass_kg + 2 * slosh_kg(); }

struct Lander::Model {
  explicit Model(const Design& design)
      : matter(system),
        forces(system),
        gravity(forces, matter, Vec3(0, 0, -design.gravity_mps2)),
        bus(matter.updGround(),
            SimTK::Body::Rigid(SimTK::MassProperties(design.bus_kg, Vec3(0),
                                                     SimTK::Inertia(to_simbody(design.bus_inertia_kgm2))))),
        thrusters(new Thrusters(bus.getMobilizedBodyIndex(), matter)),
        thruster_force(forces, thrusters),
        integrator(system) {
    for (int leg = 0; leg < design.legs.count; ++leg) add_leg(design, leg);
    for (const double side : {1.0, -1.0}) add_tank(design, side);
    integrator.setAccuracy(kAccuracy);
    integrator.setAllowInterpolation(false);
  }

  void add_leg(const Design& design, int leg) {
    const double m = design.legs.mass_kg, length = design.legs.length_m;
    const double inertia = m * length * length / 3, rate = 2 * SimTK::Pi * design.legs.frequency_hz;
    const SimTK::Body::Rigid rod(
        SimTK::MassProperties(m, Vec3(length / 2, 0, 0), SimTK::Inertia(0, inertia, inertia)));
    legs.emplace_back(bus, leg_hinge(design, leg), rod, SimTK::Transform());
    SimTK::Force::MobilityLinearSpring(forces, legs.back(), SimTK::MobilizerQIndex(0), inertia * rate * rate,
                                       0);
    SimTK::Force::MobilityLinearDamper(forces, legs.back(), SimTK::MobilizerUIndex(0),
                                       2 * design.legs.damping_ratio * inertia * rate);
  }

  void add_tank(const Design& design, double side) {
    const double m = design.slosh_kg(), rod = design.rod_m();
    const Vec3 at(0, 0, -rod);
    const SimTK::Body::Rigid pendulum(SimTK::MassProperties(m, at, m * SimTK::UnitInertia::pointMassAt(at)));
    const Vec3 hinge(side * design.tanks.offset_m, 0, design.tanks.hinge_z_m);
    slosh.emplace_back(bus, SimTK::Transform(hinge), pendulum, SimTK::Transform());
    const double damping =
        2 * design.tanks.damping_ratio * m * rod * rod * std::sqrt(design.gravity_mps2 / rod);
    for (int axis = 0; axis < 2; ++axis)
      SimTK::Force::MobilityLinearDamper(forces, slosh.back(), SimTK::MobilizerUIndex(axis), damping);
  }

  void start(const Design& design, const Start& start) {
    SimTK::State state = system.realizeTopology();
    const Quaterniond& q = start.bus.attitude;
    bus.setQToFitTransform(state, {SimTK::Rotation(SimTK::Quaternion(q.w(), q.x(), q.y(), q.z())),
                                   to_simbody(start.bus.position_m)});
    bus.setUToFitVelocity(state, {to_simbody(q * start.bus.rate_radps), to_simbody(start.bus.velocity_mps)});
    for (const MobilizedBody& leg : legs) leg.setOneQ(state, 0, start.leg_rad);
    for (std::size_t tank = 0; tank < slosh.size(); ++tank) {
      for (int axis = 0; axis < 2; ++axis) slosh[tank].setOneQ(state, axis, start.slosh_rad.at(tank)[axis]);
      if (!design.tanks.swing) slosh[tank].lock(state);
    }
    integrator.initialize(state);
  }

  [[nodiscard]] const SimTK::State& now() const { return integrator.getState(); }

  SimTK::MultibodySystem system;
  SimTK::SimbodyMatterSubsystem matter;
  SimTK::GeneralForceSubsystem forces;
  SimTK::Force::UniformGravity gravity;
  MobilizedBody::Free bus;
  std::vector<MobilizedBody::Pin> legs;
  std::vector<MobilizedBody::Universal> slosh;
  Thrusters* thrusters;  ///< owned by thruster_force
  SimTK::Force::Custom thruster_force;
  SimTK::RungeKuttaMersonIntegrator integrator;
};

Lander::Lander(const Design& design, const Start& start) : model_(std::make_unique<Model>(design)) {
  model_->start(design, start);
}

Lander::~Lander() = default;

void Lander::set(const Controls& controls) {
  model_->thrusters->controls = controls;
  model_->integrator.reinitialize(SimTK::Stage::Dynamics, false);
}

void Lander::advance_to(double t_s) {
  while (model_->integrator.getTime() < t_s) model_->integrator.stepTo(t_s, t_s);
}

double Lander::t_s() const { return model_->integrator.getTime(); }

BusState Lander::bus() const {
  const SimTK::State& state = model_->now();
  const MobilizedBody& bus = model_->bus;
  const SimTK::Rotation& R_ground_bus = bus.getBodyRotation(state);
  const SimTK::Quaternion q = R_ground_bus.convertRotationToQuaternion();
  return {to_eigen(bus.getBodyOriginLocation(state)), to_eigen(bus.getBodyOriginVelocity(state)),
          Quaterniond(q[0], q[1], q[2], q[3]), to_eigen(~R_ground_bus * bus.getBodyAngularVelocity(state))};
}

std::vector<Vector2d> Lander::slosh_rad() const {
  std::vector<Vector2d> angles;
  for (const MobilizedBody& tank : model_->slosh)
    angles.emplace_back(tank.getOneQ(model_->now(), 0), tank.getOneQ(model_->now(), 1));
  return angles;
}

std::vector<double> Lander::legs_rad() const {
  std::vector<double> angles;
  for (const MobilizedBody& leg : model_->legs) angles.push_back(leg.getOneQ(model_->now(), 0));
  return angles;
}

std::vector<BodyMotion> Lander::bodies() const {
  const SimTK::State& state = model_->now();
  std::vector<BodyMotion> bodies;
  for (SimTK::MobilizedBodyIndex i(1); i < model_->matter.getNumBodies(); ++i) {
    const MobilizedBody& body = model_->matter.getMobilizedBody(i);
    const Vec3 centre = body.getBodyMassCenterStation(state);
    const Matrix3d R_dem_body = to_eigen(body.getBodyRotation(state).asMat33());
    const Matrix3d inertia = to_eigen(body.getBodyMassProperties(state).calcCentralInertia().toMat33());
    bodies.push_back({body.getBodyMass(state), R_dem_body * inertia * R_dem_body.transpose(),
                      to_eigen(body.findStationLocationInGround(state, centre)),
                      to_eigen(body.findStationVelocityInGround(state, centre)),
                      to_eigen(body.getBodyAngularVelocity(state))});
  }
  return bodies;
}

}  // namespace lander
