// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace landfall {

/// What became of one pixel at one pulse. The values are those of the scan file.
enum class PointStatus : std::int8_t {
  returned = 0,
  miss = 1,
  dropout = 2,
  dead = 3,
  blanked = 4,
  lost_in_optics = 5,
  false_return = 6,
};
inline constexpr std::size_t kPointStatusCount = 7;

/// True where there is a range: a return, or a false one.
[[nodiscard]] inline bool is_return(PointStatus status) {
  return status == PointStatus::returned || status == PointStatus::false_return;
}

/// One row per pixel and pulse, ordered by pulse, then pixel. Positions in D and ranges in metres; NaN where
/// the status leaves none:
/// - a return has everything;
/// - so has a false return, but that its range_true is NaN where nothing was hit; its true point is then that
///   of the true beam at the false range;
/// - a dropout, and a dead pixel whose ray met the terrain, keep range_true and the true point;
/// - all others have nothing.
/// The columns that errors without false returns do not change (x_true, y_true, z_true, range_true, pulse,
/// pixel) may be left out: they are then empty.
struct PointColumns {
  std::vector<double> x_est, y_est, z_est;     ///< Eq. 7, from the measured range and the estimated pose
  std::vector<double> x_true, y_true, z_true;  ///< Eq. 1, from the true range and the true pose
  std::vector<double> range_true, range_measured;
  std::vector<std::int32_t> pulse;
  std::vector<std::int32_t> pixel;  ///< row * columns + column
  std::vector<PointStatus> status;

  [[nodiscard]] std::size_t size() const { return status.size(); }
  [[nodiscard]] bool holds_truth() const { return !pixel.empty(); }

  /// Calls visit(name, column) for each column, under its name in the scan file.
  template <class Self, class Visit>
  static void for_each(Self& self, Visit&& visit) {
    visit("x_est", self.x_est);
    visit("y_est", self.y_est);
    visit("z_est", self.z_est);
    visit("x_true", self.x_true);
    visit("y_true", self.y_true);
    visit("z_true", self.z_true);
    visit("range_true", self.range_true);
    visit("range_measured", self.range_measured);
    visit("pulse", self.pulse);
    visit("pixel", self.pixel);
    visit("status", self.status);
  }
  friend bool operator==(const PointColumns&, const PointColumns&) = default;
};

/// One row per pulse: t in seconds, the scanner's two angles in radians, and the pose of the body in D:
/// position in metres, quaternion D <- B scalar first, its scalar >= 0.
struct PulseColumns {
  std::vector<double> t;
  std::vector<double> angle_1, angle_2;
  std::vector<double> px_true, py_true, pz_true, qw_true, qx_true, qy_true, qz_true;
  std::vector<double> px_est, py_est, pz_est, qw_est, qx_est, qy_est, qz_est;
  std::vector<std::int32_t> point_count;  ///< rows of this pulse in the points

  [[nodiscard]] std::size_t size() const { return point_count.size(); }

  /// As PointColumns::for_each.
  template <class Self, class Visit>
  static void for_each(Self& self, Visit&& visit) {
    visit("t", self.t);
    visit("angle_1", self.angle_1);
    visit("angle_2", self.angle_2);
    visit("px_true", self.px_true);
    visit("py_true", self.py_true);
    visit("pz_true", self.pz_true);
    visit("qw_true", self.qw_true);
    visit("qx_true", self.qx_true);
    visit("qy_true", self.qy_true);
    visit("qz_true", self.qz_true);
    visit("px_est", self.px_est);
    visit("py_est", self.py_est);
    visit("pz_est", self.pz_est);
    visit("qw_est", self.qw_est);
    visit("qx_est", self.qx_est);
    visit("qy_est", self.qy_est);
    visit("qz_est", self.qz_est);
    visit("point_count", self.point_count);
  }
  friend bool operator==(const PulseColumns&, const PulseColumns&) = default;
};

/// Which columns of the points a batch holds.
enum class PointContent {
  all,
  estimate,  ///< those that errors change: x_est, y_est, z_est, range_measured, status
};

/// Consecutive pulses with all their pixels. Its memory is kept from one use to the next.
struct PulseBatch {
  PointColumns points;
  PulseColumns pulses;

  /// Room for every pixel of every pulse. Values are left as they are: whoever resizes fills all rows.
  void resize(std::size_t pulse_count, std::size_t pixel_count, PointContent content = PointContent::all);
  /// Rows per status, indexed by its value.
  [[nodiscard]] std::array<std::int64_t, kPointStatusCount> status_counts() const;
  /// Removes all points but returns and false returns; the order and the pulses stay.
  void keep_returns();
};

}  // namespace landfall
