// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/exports/point_reader.h"
#include "base/core/progress.h"
#include "base/numerics/non_finite.h"
#include "base/output/byte_sink.h"

namespace landfall {

/// Bytes of the public header block of LAS 1.2 and of LAS 1.4, of a point of format 1, and of one of format
/// 0, without time.
inline constexpr std::size_t kLasHeaderBytes = 227;
inline constexpr std::size_t kLas14HeaderBytes = 375;
inline constexpr std::size_t kLasPointBytes = 28;
inline constexpr std::size_t kLasUntimedPointBytes = 20;

/// The box of points. Empty: low > high.
struct PointBox {
  std::array<double, 3> low = {kInfinity, kInfinity, kInfinity};
  std::array<double, 3> high = {-kInfinity, -kInfinity, -kInfinity};
};

/// How LAS stores coordinates: X = round((x - offset) / scale), 32 bits; metres, or the unit of a map.
struct LasGrid {
  std::array<double, 3> scale = {1e-6, 1e-6, 1e-6};
  std::array<double, 3> offset = {0, 0, 0};

  /// The finest of 1e-6, 1e-5 and 1e-4, the same on all axes, that the box fits in, around its centre to the
  /// next whole number; for longitude and latitude of 1e-9 to 1e-7 (0.1 mm to 1 cm on the Earth). Throws
  /// FormatError, naming the extent and the most that fits, for a larger box.
  static LasGrid fitting(const PointBox& box, const std::string& file,
                         const std::optional<MapFrame>& map = {});

  [[nodiscard]] std::int32_t stored(double coordinate, std::size_t axis) const;
  /// The coordinate that a reader computes.
  [[nodiscard]] double read_back(std::int32_t stored, std::size_t axis) const {
    return stored * scale[axis] + offset[axis];
  }
};

/// The meaning of the GPS times of points.
enum class LasTime {
  scan,  ///< seconds since the first pulse
  gps,   ///< adjusted standard GPS time: t - 1e9 s, t on the GPS clock, whose 0 is 1980-01-06
};

/// The content of a LAS header.
struct LasContent {
  LasGrid grid;
  PointBox box;
  std::size_t count = 0;                         ///< at most 2^32 - 1
  std::array<std::size_t, 5> count_by_return{};  ///< the first returns, the second ones, ...
  std::string software;                          ///< cut to 32 bytes
  LasTime time = LasTime::scan;                  ///< bit 0 of the global encoding is set for gps
  bool has_times = true;
  std::string file_id;    ///< of the scan: a variable-length record of user "landfall", number 1
  std::string crs_wkt{};  ///< of the map: record 2112 of user "LASF_Projection", and LAS 1.4
};

/// The public header block (LAS 1.2, ASPRS 2008; LAS 1.4, the first that has WKT, for points on a map) and
/// the records. The bounds are those of the coordinates as they are read back; the creation day is 0, so that
/// equal points give equal bytes.
[[nodiscard]] std::string las_header(const LasContent& content);

/// Which points of a scan to write, and how.
struct LasRequest {
  std::string position = "est";  ///< "est" or "true"
  std::size_t every = 1;
  LasTime time = LasTime::scan;
  std::string software;
};

/// Throws UsageError for a scan without times, an imported one, and where a pulse is sent before the
/// beginning of GPS time.
void require_gps_times(const PointReader& points);

/// Writes the selected returns as LAS 1.2, on a map 1.4, point format 1, or 0 for an imported scan without
/// times: GPS time is the pulse's time, the number of the return and of all returns of its pixel (1 of 1
/// unless the scan has several), the intensity in photoelectrons, at most 65535 (0 without a receiver),
/// classification 1 (unclassified) for a return and 7 (low point, noise) for a false return; scan angle, user
/// data and point source are 0. Throws UsageError as require_gps_times() does, and FormatError for a scan
/// that does not fit (LasGrid::fitting, more than 2^32 - 1 points).
///
/// Returns sentences about values that the file lacks or that LAS cannot hold.
std::vector<std::string> write_points_las(const PointReader& points, const LasRequest& request,
                                          ByteSink& sink, const ProgressCallback& progress = {});

}  // namespace landfall
