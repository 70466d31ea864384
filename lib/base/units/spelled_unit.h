// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// The unit of a length, an angle or a time as a file spells it.
struct SpelledUnit {
  double metres = 0;       ///< per unit; 0: not a length
  double radians = 0;      ///< per unit; 0: not an angle
  double seconds = 0;      ///< per unit; 0: not a time
  bool downwards = false;  ///< the text says that values count downwards ("m below sea level")

  [[nodiscard]] bool is_known() const { return metres > 0 || radians > 0 || seconds > 0; }
};

/// Reads a unit in any spelling of UDUNITS ("m", "metres", "1000 m", "km", "arcsec"), in other capitals where
/// these leave no doubt ("KM"), the names of feet that surveyors use ("ftUS"), and the names of a vertical
/// datum after a length ("m above MSL"). Not known where the text is something else. Throws FormatError where
/// UDUNITS cannot read its units.
[[nodiscard]] SpelledUnit spelled_unit(const std::string& text);

/// True for texts that stand for no unit: "", "1", "none", "unknown", "N/A".
[[nodiscard]] bool says_no_unit(const std::string& text);

}  // namespace landfall
