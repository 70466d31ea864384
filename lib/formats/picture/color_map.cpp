// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D240
#include "formats/picture/color_map.h"

#include <algorithm>
#include <cmath>

namespace landfall {
namespace {

/// In the order of the enumerators.
const dictionary::ColorMap& map_of(Colors colors) {
  return dictionary::kColorMaps.at(static_cast<std::size_t>(colors));
}

std::uint8_t between(std::uint8_t a, std::uint8_t b, double part) {
  return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
}

}  // namespace

const char* name_of(Colors colors) { return map_of(colors).name; }

std::span<const std::uint32_t> color_anchors(Colors colors) { return map_of(colors).anchors; }

Rgb rgb_of(std::uint32_t rrggbb) {
  const auto part = [rrggbb](unsigned shift) { return static_cast<std::uint8_t>(rrggbb >> shift & 0xffU); };
  return {part(16), part(8), part(0)};
}

Rgb color_of(double fraction, Colors colors) {
  const std::span<const std::uint32_t> anchors = color_anchors(colors);
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), anchors.size() - 2);
  const double part = position - static_cast<double>(below);
  const Rgb a = rgb_of(anchors[below]);
  const Rgb b = rgb_of(anchors[below + 1]);
  return {between(a.r, b.r, part), between(a.g, b.g, part), between(a.b, b.b, part)};
}

}  // namespace landfall
