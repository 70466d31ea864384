// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/rigid_body.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <boost/numeric/odeint/integrate/integrate_adaptive.hpp>
#include <boost/numeric/odeint/stepper/generation.hpp>
#include <boost/numeric/odeint/stepper/generation/generation_runge_kutta_fehlberg78.hpp>
#include <boost/numeric/odeint/stepper/runge_kutta_fehlberg78.hpp>

#include "geometry/vector_check.h"

namespace landfall {
namespace {

constexpr double kStepTolerance = 1e-13;

/// p, v, q (x, y, z, w as in Eigen), omega. Initialised to zero because Odeint copies its scratch memory.
struct Numbers : std::array<double, 13> {
  Numbers() : std::array<double, 13>{} {}
};
using Map = Eigen::Map<const Eigen::Vector3d>;

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
          "at most the sum of the other two, as a real body's is");
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
  namespace odeint = boost::numeric::odeint;
  Numbers x = numbers_of(from);
  using Stepper = odeint::runge_kutta_fehlberg78<Numbers, double, Numbers, double, odeint::array_algebra>;
  odeint::integrate_adaptive(odeint::make_controlled<Stepper>(kStepTolerance, kStepTolerance), derivative, x,
                             0.0, duration_s, duration_s);
  return state_of(x);
}

}  // namespace landfall
