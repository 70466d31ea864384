// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/key_unit.h"

#include <array>
#include <utility>

namespace landfall {
namespace {

/// The suffix of a key, at its end or before _per_..., and its unit.
constexpr std::array<std::pair<const char*, const char*>, 17> kUnits = {{{"_m_per_sqrt_s", "m/s^0.5"},
                                                                         {"_mps_per_sqrt_s", "m/s^1.5"},
                                                                         {"_rad_per_sqrt_s", "rad/s^0.5"},
                                                                         {"_per_km2", "1/km^2"},
                                                                         {"_per_m", "1"},
                                                                         {"_per_s", "1/s"},
                                                                         {"_m", "m"},
                                                                         {"_s", "s"},
                                                                         {"_rad", "rad"},
                                                                         {"_deg", "degrees"},
                                                                         {"_hz", "Hz"},
                                                                         {"_mps", "m/s"},
                                                                         {"_radps", "rad/s"},
                                                                         {"_degps", "degrees/s"},
                                                                         {"_mps2", "m/s^2"},
                                                                         {"_kg", "kg"},
                                                                         {"_kgm2", "kg m^2"}}};

}  // namespace

std::string_view unit_of_key(std::string_view name) {
  for (const auto& [suffix, unit] : kUnits)
    if (name.ends_with(suffix)) return unit;
  if (name.ends_with("_n")) return "N";
  return name.ends_with("_nm") ? "N m" : "";
}

}  // namespace landfall
