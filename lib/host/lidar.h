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

/// Metres, or a unit vector. Frame D: x right on the map, y up on the map, z up.
using Vector3 = std::array<double, 3>;

/// The lander's body B in D.
struct Pose {
  Vector3 position_m{};
  /// D <- B: rotates components in B into components in D. Hamilton, w, x, y, z; norm within 1e-3 of 1.
  std::array<double, 4> attitude{1, 0, 0, 0};
};

/// A half-line in D from the lidar; `direction` is a unit vector.
struct Ray {
  Vector3 origin_m{};
  Vector3 direction{};
};

/// Returns the distance along the ray to the scene, metres; NaN, infinite or negative for a miss.
using Intersect = std::function<double(const Ray& ray)>;
/// As Intersect for all rays of a pulse at once, in pixel order, then by sub-pixel; both spans have one size.
using IntersectAll = std::function<void(std::span<const Ray> rays, std::span<double> ranges_m)>;

/// Returns the columns, by name, of a table that the configuration names by `path`; it may return columns
/// that were not requested. Exceptions from it are passed on.
using ReadTable = std::function<std::map<std::string, std::vector<double>>(const std::string& path)>;

/// The values of `status` in a scan file.
enum class Status : std::int8_t {
  returned = 0,
  miss = 1,
  dropout = 2,
  dead = 3,
  blanked = 4,
  lost_in_optics = 5,
  false_return = 6,
  undetected = 7,
};

struct Pulse {
  std::int64_t number = 0;  ///< from 0; patterns and random draws depend on it
  Pose truth{};
  /// The pose that the lander estimates; if empty, the truth with the configuration's navigation error.
  std::optional<Pose> estimate{};
  /// The pose from which the pattern aims; if empty, the truth, or with the pattern's aim "estimate" the
  /// estimate. An uncompensated pattern requires it: the
  /// nominal pose of the lander at pulse 0.
  std::optional<Pose> nominal{};
  /// Time since pulse 0, seconds; if empty, number / pulse_rate_hz.
  std::optional<double> since_start_s{};
};

/// One pixel at one pulse. Values that the status leaves undefined are NaN, as in a scan file.
struct PixelReturn {
  std::int32_t pixel = 0;  ///< row * columns + column
  Status status = Status::miss;
  double range_true_m = 0;
  double range_measured_m = 0;
  Vector3 true_m{};       ///< Eq. 1, frame D
  Vector3 estimated_m{};  ///< Eq. 7, frame D
};

struct PulseReturns {
  double angle_1_rad = 0;  ///< scanner angles, as in a scan file
  double angle_2_rad = 0;
  std::vector<PixelReturn> pixels{};  ///< all pixels, in order
};

/// A lidar from scan-sim's configuration: detector, scanner, pattern, mount, noise, navigation error, seed.
/// The configuration's trajectory, its dispersion and the scan time are checked but not used.
///
/// All exceptions are std::runtime_error whose message names key, value and bound.
class Instrument {
 public:
  /// `config` is the JSON text; `name` begins every message about it. `read_table` is needed for
  /// configurations that name tables; without it they are refused.
  Instrument(const std::string& config, Intersect intersect, const std::string& name = "config",
             ReadTable read_table = {});
  Instrument(const std::string& config, IntersectAll intersect, const std::string& name = "config",
             ReadTable read_table = {});
  ~Instrument();
  Instrument(Instrument&&) noexcept;
  Instrument& operator=(Instrument&&) noexcept;
  Instrument(const Instrument&) = delete;
  Instrument& operator=(const Instrument&) = delete;

  [[nodiscard]] double pulse_rate_hz() const;
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
