// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

/// landfall's lidar inside another simulator: for each pulse, the host provides the lander's pose and traces
/// rays in its scene. This header needs only the standard library. See docs/user/module.md.
namespace landfall::lidar {

/// x, y, z in metres, or a unit vector, in frame D: x right on the map, y up on the map, z up, the origin at
/// the landing site, z = 0 at the datum of the map.
using Vector3 = std::array<double, 3>;

/// The lander's body B in D.
struct Pose {
  Vector3 position_m{};  ///< of the origin of B, frame D; finite
  /// D <- B: rotates components in B into components in D. Hamilton, w, x, y, z; norm within 1e-3 of 1.
  std::array<double, 4> attitude{1, 0, 0, 0};
};

/// A half-line in D from the lidar, as it truly is (Eq. 1).
struct Ray {
  Vector3 origin_m{};   ///< the exit point of the optics, frame D
  Vector3 direction{};  ///< unit vector, frame D
};

/// Returns the distance along the ray from its origin to the scene, metres; NaN, infinite or negative for a
/// miss. Exceptions from it are passed on, from IntersectAll too.
using Intersect = std::function<double(const Ray& ray)>;
/// As Intersect for all rays of a pulse at once, in pixel order, then by sub-pixel. Both spans have one size,
/// at most rows * columns * subpixels^2: a beam that is lost in the optics has no ray, a blanked pulse asks
/// for none.
using IntersectAll = std::function<void(std::span<const Ray> rays, std::span<double> ranges_m)>;

/// Returns the columns, by name, of a table that the configuration names by `path`: of one length, in the
/// units that end their names (`t_s`, `x_m`, `angle_1_rad`). It may return columns that were not requested.
/// Exceptions from it are passed on.
using ReadTable = std::function<std::map<std::string, std::vector<double>>(const std::string& path)>;

/// The outcome of a pixel at a pulse: the values of `status` in a scan file.
enum class Status : std::int8_t {
  returned = 0,        ///< a range was measured
  miss = 1,            ///< the scene was not hit
  dropout = 2,         ///< the return was lost at random
  dead = 3,            ///< the pixel never gives a return
  blanked = 4,         ///< the laser did not fire
  lost_in_optics = 5,  ///< the beam did not leave the scanner
  false_return = 6,    ///< the range is one of noise
  undetected = 7,      ///< the receiver saw too little light
};

/// When a pulse is fired, and from which poses.
struct Pulse {
  std::int64_t number = 0;  ///< from 0; patterns and random draws depend on it
  Pose truth{};             ///< the pose that the beams leave from
  /// The pose that the lander estimates; if empty, the truth with the configuration's navigation error.
  std::optional<Pose> estimate{};
  /// The pose from which the pattern aims; if empty, the truth, or with the pattern's aim "estimate" the
  /// estimate. An uncompensated pattern requires it: the nominal pose of the lander at pulse 0.
  std::optional<Pose> nominal{};
  /// Time since pulse 0, seconds; if empty, number / pulse_rate_hz.
  std::optional<double> since_start_s{};
};

/// One pixel at one pulse. Values that the status leaves undefined are NaN, as in a scan file.
struct PixelReturn {
  std::int32_t pixel = 0;        ///< row * columns + column; row 0 is the top of the image
  Status status = Status::miss;  ///< the outcome
  double range_true_m = 0;       ///< from the exit point to the scene along the pixel's beam
  double range_measured_m = 0;   ///< with range noise and clock
  Vector3 true_m{};              ///< where the scene was hit (Eq. 1), frame D
  Vector3 estimated_m{};         ///< the estimated position (Eq. 7), frame D
};

/// The answer to a pulse.
struct PulseReturns {
  double angle_1_rad = 0;             ///< true angles of the scanner's mechanism, as in a scan file
  double angle_2_rad = 0;             ///< the second one; 0 of a mechanism with one angle
  std::vector<PixelReturn> pixels{};  ///< all pixels, in order, also those without a return
};

/// A lidar from scan-sim's configuration: detector, scanner, pattern, mount, noise, navigation error, seed.
/// The configuration's trajectory, its dispersion and the scan time are checked but not used.
///
/// All exceptions of its own are std::runtime_error whose message names key, value and bound. An object that
/// was moved from may only be destroyed or assigned to.
class Instrument {
 public:
  /// `config` is the JSON text; `name` begins every message about it. `read_table` is needed for
  /// configurations that name tables; without it they are refused. Throws if the text is not valid JSON, a
  /// key is unknown or out of its bounds, `intersect` is empty, or the configuration has what a host gives
  /// itself (`navigation_error.table` and `attitude`, errors of time stamps) or needs what it does not give
  /// (the slope of the terrain, for noise that depends on it and for `receiver.type`).
  Instrument(const std::string& config, Intersect intersect, const std::string& name = "config",
             ReadTable read_table = {});
  /// As above, with a callback that takes all rays of a pulse at once.
  Instrument(const std::string& config, IntersectAll intersect, const std::string& name = "config",
             ReadTable read_table = {});
  ~Instrument();
  /// Takes over the lidar of another object.
  Instrument(Instrument&&) noexcept;
  /// Replaces this lidar by that of another object.
  Instrument& operator=(Instrument&&) noexcept;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  /// Pulses per second, `laser.pulse_rate_hz`.
  [[nodiscard]] double pulse_rate_hz() const;
  /// Rows * columns of the detector, the size of PulseReturns::pixels.
  [[nodiscard]] std::size_t pixel_count() const;
  /// The number of pulses after which the pattern ends; empty if it does not end.
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const;

  /// The result depends only on the pulse, and equals that of scan-sim for the same poses and terrain. Pulses
  /// may come in any order, and from several threads if the host's callback allows it. Throws if the scanner
  /// cannot follow the aim, a pose is not finite, a quaternion does not have norm 1, or a number is negative
  /// or exceeds 2^31.
  [[nodiscard]] PulseReturns step(const Pulse& pulse) const;
  /// As above, but reuses the memory of `returns`.
  void step(const Pulse& pulse, PulseReturns& returns) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace landfall::lidar
