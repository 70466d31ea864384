// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

namespace landfall {

/// A smooth function of the plane, as products of Chebyshev polynomials over a square around the origin: a
/// stand-in for one that is slow or not safe to call from several threads.
class SmoothMap {
 public:
  using Function = std::function<Eigen::Vector2d(const Eigen::Vector2d&)>;

  /// The polynomial of lowest degree (4, 8, 16, 32) that is within `tolerance` of the function at points
  /// between those that define it; none where no degree is. Calls the function some 5 to 3,000 times.
  [[nodiscard]] static std::optional<SmoothMap> fitted(const Function& function, double half_width,
                                                       double tolerance);

  /// Points beyond the square are extrapolated.
  [[nodiscard]] Eigen::Vector2d at(const Eigen::Vector2d& point) const;

 private:
  SmoothMap(const Function& function, double half_width, int degree);
  [[nodiscard]] bool agrees(const Function& function, double tolerance) const;

  double half_width_;
  int degree_;
  std::vector<Eigen::Vector2d> coefficients_;  ///< of T_i(x) T_j(y) at i (degree + 1) + j
};

}  // namespace landfall
