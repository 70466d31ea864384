// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/trajectory/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/controlled_runge_kutta.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "base/geometry/vector_check.h"
#include "base/numerics/portable_math.h"

namespace landfall {
namespace {

constexpr double kStepTolerance = 1e-13;

/// p, v, q (x, y, z, w as in Eigen), omega. Initialised to zero because Odeint copies its scratch memory.
struct Numbers : std::array<double, 13> {
  Numbers() : std::array<double, 13>{} {}
};
using Map = Eigen::Map<const Eigen::Vector3d>;

namespace odeint = boost::numeric::odeint;

/// Odeint's rule for the length of a step, by a power that is the same on every processor.
struct StepAdjuster : odeint::default_step_adjuster<double, double> {
  [[nodiscard]] static double decrease_step(double step_s, double error, int order) {
    return step_s * std::max(0.9 * portable::pow(error, -1.0 / (order - 1)), 0.2);
  }
  [[nodiscard]] static double increase_step(double step_s, double error, int order) {
    if (error >= 0.5) return step_s;
    return step_s * (0.9 * portable::pow(std::max(portable::pow(5, -order), error), -1.0 / order));
  }
};
using Stepper = odeint::runge_kutta_fehlberg78<Numbers, double, Numbers, double, odeint::array_algebra>;
using ErrorChecker = odeint::default_error_checker<double, odeint::array_algebra, odeint::default_operations>;
using ControlledStepper = odeint::controlled_runge_kutta<Stepper, ErrorChecker, StepAdjuster>;

Numbers numbers_of(const RigidBodyState& s) {
  Numbers x;
  Eigen::Map<Eigen::Vector3d>(x.data()) = s.position_m.v;
  Eigen::Map<Eigen::Vector3d>(x.data() + 3) = s.velocity_mps.v;
  Eigen::Map<Eigen::Vector4d>(x.data() + 6) = s.attitude.coeffs();
  Eigen::Map<Eigen::Vector3d>(x.data() + 10) = s.rate_radps.v;
  return x;
}

RigidBodyState state_of(const Numbers& x) {
  RigidBodyState s{{Map(x.data())}, {Map(x.data() + 3)}, {}, {Map(x.data() + 10)}};
  s.attitude.coeffs() = Eigen::Map<const Eigen::Vector4d>(x.data() + 6);
  s.attitude.normalize();
  return s;
}

void require_real(const Eigen::Matrix3d& inertia) {
  const ParameterName name{"", "inertia_kgm2"};
  for (int i = 0; i < 9; ++i) require_finite(name, inertia.data()[i]);
  const double skew = (inertia - inertia.transpose()).cwiseAbs().maxCoeff();
  require(skew <= 1e-12 * inertia.cwiseAbs().maxCoeff(), {"", "inertia_kgm2 minus its transpose"}, skew,
          "0: the matrix must be symmetric");
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
  require(moments[0] > 0, {"", "inertia_kgm2's smallest principal moment"}, moments[0], "positive");
  require(moments[2] <= (moments[0] + moments[1]) * (1 + 1e-12),
          {"", "inertia_kgm2's largest principal moment"}, moments[2],
          "at most the sum of the other two, as in any rigid body");
}

}  // namespace

RigidBodyMotion::RigidBodyMotion(const RigidBody& body) : body_(body) {
  require_positive({"", "mass_kg"}, body.mass_kg);
  require_real(body.inertia_kgm2);
  inverse_inertia_ = body.inertia_kgm2.inverse();
}

RigidBodyState RigidBodyMotion::after(double duration_s, const RigidBodyState& from, const Load& load) const {
  const auto derivative = [&](const Numbers& x, Numbers& dxdt, double /*t*/) {
    const Map v(x.data() + 3);
    const Map omega(x.data() + 10);
    const Eigen::Quaterniond q(Eigen::Map<const Eigen::Vector4d>(x.data() + 6));
    Eigen::Map<Eigen::Vector3d>(dxdt.data()) = v;
    Eigen::Map<Eigen::Vector3d>(dxdt.data() + 3) =
        load.gravity_mps2.v + q.toRotationMatrix() * load.force_n.v / body_.mass_kg;
    Eigen::Map<Eigen::Vector4d>(dxdt.data() + 6) =
        0.5 * (q * Eigen::Quaterniond(0, omega.x(), omega.y(), omega.z())).coeffs();
    Eigen::Map<Eigen::Vector3d>(dxdt.data() + 10) =
        inverse_inertia_ * (load.torque_nm.v - omega.cross(body_.inertia_kgm2 * omega));
  };
  Numbers x = numbers_of(from);
  odeint::integrate_adaptive(ControlledStepper(ErrorChecker(kStepTolerance, kStepTolerance)), derivative, x,
                             0.0, duration_s, duration_s);
  return state_of(x);
}

}  // namespace landfall
