// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/points/cloud_bytes.h"
#include "formats/points/cloud_reader.h"
#include "formats/points/row_reader.h"

namespace landfall {

/// The header of a LAS file and what its variable-length records say of its points.
struct LasHeader {
  int minor = 0;
  std::uint8_t format = 0;
  bool has_gps_time_of_1980 = false;  ///< adjusted standard GPS time, not seconds of the week
  std::size_t time_offset = 0;        ///< of the GPS time within a point; 0: none
  std::size_t width_offset = 0;       ///< of an uint16, the full width at half maximum of its echo; 0: none
  double width_m = 0;                 ///< standard deviation of the echo per unit of that
  RowLayout rows;
  CloudSteps steps{};
  CloudBox box{};
  std::string crs_wkt{};
  std::optional<CloudGeoKeys> geo_keys{};
  std::vector<std::string> notes{};

  [[nodiscard]] bool is_extended() const { return format >= 6; }
};

/// Reads LAS 1.0 to 1.4. Throws FormatError, naming both values where two statements contradict each other:
/// another version or point format, LAZ, a header, record or point that reaches beyond its place, points
/// shorter than their format or than the extra bytes that are declared, 32-bit and 64-bit counts that
/// differ, counts by return that exceed the count, fewer points than declared, and bytes behind the points
/// that make whole points. Other bytes that no record accounts for are named in `notes`.
[[nodiscard]] LasHeader read_las_header(const CloudBytes& file);

}  // namespace landfall
