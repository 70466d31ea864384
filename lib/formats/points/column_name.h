// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace landfall {

/// The unit that the name of a column states.
struct ColumnUnit {
  enum class Kind { unstated, unknown, length, angle, time };
  Kind kind = Kind::unstated;
  double factor = 1;   ///< to metres, degrees or seconds; negative where values count downwards
  std::string text{};  ///< as the name spells it; empty for degrees that only the name says: lon
};

/// One way to read the name of a column: "x_mm" is xmm without a unit, or x in mm.
struct NameReading {
  std::string plain;  ///< lower case, letters and digits only, without CloudCompare's "scalar"
  ColumnUnit unit;
  bool is_suffix = false;  ///< the unit is not in brackets, so that it may be a part of the name
};

/// The ways to read a name; the one without a suffix comes first. A unit stands in brackets of any kind
/// ("x [mm]", "Elevation (ft)"), or behind a separator ("x_mm", "E/m", "x in mm"). ParaView's names of the
/// coordinates of points ("Points_m_XYZ:0") are x, y and z. Longitudes and latitudes are in degrees by their
/// names.
[[nodiscard]] std::vector<NameReading> readings_of(std::string_view name);

}  // namespace landfall
