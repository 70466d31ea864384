// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace landfall {

/// D: x right on the map (east), y up on the map (north), z up, metres, origin at the intended landing site.
struct DemFrame {};
/// B: fixed to the lander; nominally aligned with D.
struct BodyFrame {};
/// L: fixed to the lidar, +z out along the boresight, +y down the image. Nominally diag(1, -1, -1) from B.
struct LidarFrame {};

/// A displacement in frame F; metres unless its name says otherwise.
template <class F>
struct Vector {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();

  friend Vector operator+(const Vector& a, const Vector& b) { return {a.v + b.v}; }
  friend Vector operator-(const Vector& a, const Vector& b) { return {a.v - b.v}; }
  friend Vector operator-(const Vector& a) { return {-a.v}; }
  friend Vector operator*(double s, const Vector& a) { return {s * a.v}; }
  [[nodiscard]] double norm() const { return v.norm(); }
  friend bool operator==(const Vector&, const Vector&) = default;
};

/// A unit vector in frame F. Code that makes one from components must normalise it.
template <class F>
struct Direction {
  Eigen::Vector3d v = Eigen::Vector3d::UnitZ();

  /// The direction of a vector; the zero vector has none and gives NaN.
  static Direction of(const Vector<F>& a) { return {a.v / a.v.norm()}; }
  friend Vector<F> operator*(double length, const Direction& d) { return {length * d.v}; }
  friend bool operator==(const Direction&, const Direction&) = default;
};

/// A position in frame F, metres.
template <class F>
struct Point {
  Eigen::Vector3d v = Eigen::Vector3d::Zero();

  friend Point operator+(const Point& p, const Vector<F>& a) { return {p.v + a.v}; }
  friend Point operator-(const Point& p, const Vector<F>& a) { return {p.v - a.v}; }
  friend Vector<F> operator-(const Point& a, const Point& b) { return {a.v - b.v}; }
  friend bool operator==(const Point&, const Point&) = default;
};

/// R_to_from: turns components in From into components in To. Products whose inner frames differ do not
/// compile.
template <class To, class From>
struct Rotation {
  Eigen::Matrix3d m = Eigen::Matrix3d::Identity();

  [[nodiscard]] Rotation<From, To> inverse() const { return {m.transpose()}; }
  friend Vector<To> operator*(const Rotation& R, const Vector<From>& a) { return {R.m * a.v}; }
  friend Direction<To> operator*(const Rotation& R, const Direction<From>& d) { return {R.m * d.v}; }
  template <class Inner>
  friend Rotation<To, Inner> operator*(const Rotation& R, const Rotation<From, Inner>& S) {
    return {R.m * S.m};
  }
  friend bool operator==(const Rotation&, const Rotation&) = default;
};

/// T_to_from: a rigid motion; `position` is the origin of From, seen in To.
template <class To, class From>
struct Transform {
  Rotation<To, From> rotation;
  Point<To> position;

  [[nodiscard]] Transform<From, To> inverse() const {
    const Rotation<From, To> R = rotation.inverse();
    return {R, Point<From>{-(R.m * position.v)}};
  }
  friend Point<To> operator*(const Transform& T, const Point<From>& p) {
    return {T.rotation.m * p.v + T.position.v};
  }
  template <class Inner>
  friend Transform<To, Inner> operator*(const Transform& T, const Transform<From, Inner>& S) {
    return {T.rotation * S.rotation, T * S.position};
  }
  friend bool operator==(const Transform&, const Transform&) = default;
};

}  // namespace landfall
