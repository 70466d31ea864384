// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "ray/opencl/plugin.h"

namespace landfall {

// The structures that draws.cl has too, with the same layout: all members have eight bytes.

/// What all draws share.
struct DeviceScene {
  double resolution_m, first_row, first_col, rows, cols;  ///< GridSpec
  std::int64_t pixels;                                    ///< of a pulse
};

/// How a point is added to bins.
enum class DeviceWeights : std::int64_t {
  bilinear,  ///< Method::bilinear_nearest
  equal,     ///< Method::mean
  four,      ///< Method::bilinear4
};

/// RangeErrorParameters and RandomStreams of one draw.
struct DeviceErrors {
  std::uint64_t seed, noise_stream, dropout_stream, false_stream;
  double sigma_m, sigma_per_m, incidence_sigma_rad, bias_m, dropout_frac, false_frac, false_min_m,
      false_span_m;
  std::int64_t is_noisy, has_constant_sigma;
  DeviceWeights weights;
  /// Bit i: the CPU adds the three products of row i of a rotation from the left; else from the right.
  std::int64_t left_rows;
};

/// One pixel of one pulse. No draw changes it.
struct DeviceBeam {
  double range_m;  ///< true; NaN for a miss; -infinity where no return is possible: blanked or lost in the
                   ///< optics
  double tan_incidence;
  std::array<double, 3> direction, exit;  ///< in L
};

/// T_dem_lidar of one pulse.
struct DevicePose {
  std::array<double, 9> rotation;  ///< row by row
  std::array<double, 3> position;
};
static_assert(sizeof(DeviceScene) == 6 * 8 && sizeof(DeviceErrors) == 16 * 8 && sizeof(DeviceBeam) == 8 * 8 &&
              sizeof(DevicePose) == 12 * 8);

/// What comes back from a device, row-major: of BinValues what a judged DEM needs. A bin without returns has
/// the count 0, and its other values mean nothing.
struct DeviceBins {
  static constexpr std::size_t kLayers = 5;  ///< z_est, x_true, y_true, x_offset, y_offset
  std::span<double> layers;                  ///< kLayers times the bins
  std::span<std::int32_t> counts;
};

/// A scan in the memory of a device, 64 bytes per beam, on which errors are drawn.
class DeviceDraws {
 public:
  virtual ~DeviceDraws() = default;
  [[nodiscard]] virtual const OpenClDevice& device() const = 0;
  /// Adds the beams of the next pulses, which may be destroyed afterwards. A draw processes the pulses of one
  /// call together.
  virtual void add_pulses(std::span<const DeviceBeam> beams) = 0;
  /// Draws the errors and adds the points to the bins, in the order of the scan. `believed`: one for each
  /// pulse; `dead`: one for each pixel. From one thread at a time. Throws DeviceError if the device fails.
  virtual void draw(const DeviceErrors& errors, std::span<const DevicePose> believed,
                    std::span<const std::int8_t> dead, const DeviceBins& bins) = 0;
};

/// The functions of the plugin landfall-opencl.so that draw errors.
struct OpenClDrawsPlugin {
  const char* version;
  /// A scan without beams on the device of the given number (OpenClPlugin::devices). `truth`: the true pose
  /// of each pulse.
  std::unique_ptr<DeviceDraws> (*load)(const DeviceScene& scene, std::span<const DevicePose> truth,
                                       std::size_t device);
};

/// The name of the plugin's object of type OpenClDrawsPlugin.
inline constexpr const char* kOpenClDrawsSymbol = "landfall_opencl_draws";

}  // namespace landfall
