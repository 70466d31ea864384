// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landfall {

/// exp: the Hamilton quaternion that rotates by |phi| radians about phi. Exact to rounding for every phi,
/// including zero.
[[nodiscard]] Eigen::Quaterniond quaternion_of(const Eigen::Vector3d& phi);

/// log: the shortest rotation vector of a unit quaternion, |phi| <= pi; q and -q give the same.
[[nodiscard]] Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& q);

/// d(phi)/dt where R(t) = R0 exp(phi(t)) rotates at the rate `omega`, seen in the rotating frame (Bortz 1971,
/// Eq. 10): omega + phi x omega / 2 + c phi x (phi x omega), c = (1 - a/2 cot(a/2)) / a^2, a = |phi| < 2 pi.
[[nodiscard]] Eigen::Vector3d rotation_vector_rate(const Eigen::Vector3d& phi, const Eigen::Vector3d& omega);

}  // namespace landfall
