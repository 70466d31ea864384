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

/// landfall's lidar inside another simulator: the host moves the lander and holds the scene, pulse by pulse.
/// This header needs nothing but the standard library. See docs/user/module.md.
namespace landfall::lidar {

/// Metres, or a unit vector. Frame D: x right on the map, y up on the map, z up.
using Vector3 = std::array<double, 3>;

/// The lander's body B in D.
struct Pose {
  Vector3 position_m{};
  /// D <- B: turns components in B into components in D. Hamilton, w, x, y, z; its norm within 1e-3 of 1.
  std::array<double, 4> attitude{1, 0, 0, 0};
};

/// A half-line in D from the lidar; `direction` is a unit vector.
struct Ray {
  Vector3 origin_m{};
  Vector3 direction{};
};

/// The distance along the ray to the scene, metres; a miss is NaN, infinite or negative.
using Intersect = std::function<double(const Ray& ray)>;
/// The same for all rays of a pulse at once, in pixel order, sub-pixels within; both spans have one size.
using IntersectAll = std::function<void(std::span<const Ray> rays, std::span<double> ranges_m)>;

/// The columns, by name, of a table that the configuration names by `path`; columns that are not asked for
/// may be among them. What it throws passes through.
using ReadTable = std::function<std::map<std::string, std::vector<double>>(const std::string& path)>;

/// As `status` in a scan file.
enum class Status : std::int8_t {
  returned = 0,
  miss = 1,
  dropout = 2,
  dead = 3,
  blanked = 4,
  lost_in_optics = 5,
  false_return = 6,
};

struct Pulse {
  std::int64_t number = 0;  ///< from 0; patterns and random draws go by it
  Pose truth{};
  /// What the lander believes; none: the truth, less the configuration's navigation error.
  std::optional<Pose> estimate{};
  /// The pose that the pattern aims from; none: the truth. An uncompensated pattern needs it: where the
  /// lander nominally was at pulse 0.
  std::optional<Pose> nominal{};
  /// Time since pulse 0; none: number / pulse_rate_hz.
  std::optional<double> since_start_s{};
};

/// One pixel at one pulse. What the status leaves undefined is NaN, as in a scan file.
struct PixelReturn {
  std::int32_t pixel = 0;  ///< row * columns + column
  Status status = Status::miss;
  double range_true_m = 0;
  double range_measured_m = 0;
  Vector3 true_m{};       ///< Eq. 1, frame D
  Vector3 estimated_m{};  ///< Eq. 7, frame D
};

struct PulseReturns {
  double angle_1_rad = 0;  ///< the scanner's, as in a scan file
  double angle_2_rad = 0;
  std::vector<PixelReturn> pixels{};  ///< all of them, in order
};

/// A lidar as scan-sim's configuration describes it: detector, scanner, pattern, mount, noise, navigation
/// error, seed. The configuration's trajectory and scan time are checked but not used.
///
/// Everything it throws is a std::runtime_error whose message names key, value and bound.
class Instrument {
 public:
  /// `config` is the JSON text; `name` begins every message about it. `read_table` serves configurations that
  /// name tables; without it those are refused.
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
  /// The pulses after which the pattern stops; none for one that goes on.
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const;

  /// A function of the pulse only, with the returns that scan-sim gives for the same poses and terrain.
  /// Pulses may come in any order, and from several threads where the host's callback allows it. Throws where
  /// the scanner cannot follow the aim, a pose is not finite or its quaternion not of norm 1, or a number is
  /// negative or past 2^31.
  [[nodiscard]] PulseReturns step(const Pulse& pulse) const;
  /// The same into memory that is used again.
  void step(const Pulse& pulse, PulseReturns& returns) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace landfall::lidar
