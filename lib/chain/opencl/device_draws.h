// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "base/numerics/wide_sum.h"
#include "chain/opencl/plugin.h"

namespace landfall {

// The structures that draws.cl and verdict.cl have too, with the same layout: all members have eight bytes.

/// The inputs that all draws share.
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
  std::uint64_t seed, draw, noise_stream, dropout_stream, false_stream;
  double sigma_m, sigma_per_m, spread_rad, bias_m, dropout, false_frac, false_min_m, false_span_m;
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
static_assert(sizeof(DeviceScene) == 6 * 8 && sizeof(DeviceErrors) == 17 * 8 && sizeof(DeviceBeam) == 8 * 8 &&
              sizeof(DevicePose) == 12 * 8);

/// TriangulatedGrid: where a device takes true elevations.
struct DeviceSurface {
  double resolution_m, anchor, first_row, first_col;
  std::int64_t rows, cols;
};

/// EvaluationParameters and TruthAt of one draw.
struct DeviceRule {
  double quantile;
  std::array<double, 3> relative_m;  ///< by axis
  double horizontal_m;
  std::int64_t half_bins, is_square;  ///< Footprint
  std::int64_t at_centroid;
  std::int64_t has_maps;  ///< by DeviceDraws, not by its caller
};
static_assert(sizeof(DeviceSurface) == 6 * 8 && sizeof(DeviceRule) == 9 * 8);

/// The inputs that the verdicts of all draws share. Grids are row-major.
struct DeviceJudged {
  DeviceSurface surface;
  std::span<const double> nodes;  ///< elevations, of the surface
  std::span<const std::int8_t> region;
  std::span<const double> map_truth;  ///< DrawRunner::map_truth(); empty in a run of draws without maps
};

/// A verdict, read back from the device.
struct DeviceVerdict {
  /// Numbers of footprints centred on the region: those with FailFlag 1, 2, 4 and 8, those with a value in x,
  /// in y and in z, and those with one in x and in y.
  std::array<std::int64_t, 8> counts{};
  std::span<std::int8_t> valid;  ///< valid_bins()
};

/// DrawMaps of the draws that a device has judged, to be filled.
struct DeviceSums {
  std::array<std::span<std::int32_t>, 7> counts;  ///< invalid, DrawMaps::failing, e_z, e_map
  std::array<std::span<std::int64_t>, 3> sums;    ///< count, e_z, e_map
  std::array<std::span<WideSum>, 2> squares;      ///< e_z, e_map
};

/// Bins read back from a device, row-major: the members of BinValues that a judged DEM needs. A bin without
/// returns has the count 0, and its other values mean nothing.
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
  /// Forgets all beams.
  virtual void clear_pulses() = 0;
  /// Draws the errors and adds the points to the bins, in the order of the scan. `estimated`: one for each
  /// pulse; `dead`: one for each pixel. From one thread at a time, as all that follows. Throws DeviceError if
  /// the device fails.
  virtual void draw(const DeviceErrors& errors, std::span<const DevicePose> estimated,
                    std::span<const std::int8_t> dead) = 0;
  /// The bins of the last draw.
  virtual void read(const DeviceBins& bins) = 0;

  /// Before the first judge(). Needs 8 bytes per node and 67 per bin, with maps 159.
  virtual void prepare_verdicts(const DeviceJudged& judged) = 0;
  /// Judges the last draw and adds it to the maps. Returns false, having added nothing, for the CPU to do
  /// both: where errors are infinite or beyond +-65,536 m, or rounding decides about the absolute error.
  /// `half_widths`: Footprint::half_width() from 0 on.
  [[nodiscard]] virtual bool judge(const DeviceRule& rule, std::span<const std::int64_t> half_widths,
                                   DeviceVerdict& verdict) = 0;
  /// Takes the sums since the last call.
  virtual void take_sums(const DeviceSums& out) = 0;
};

}  // namespace landfall
