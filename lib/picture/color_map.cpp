// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D240
#include "picture/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace landfall {
namespace {

// The same table is in python/landfall/colors.py; tests/chain/report_browser_test.py compares them.
constexpr std::array<std::uint32_t, 17> kCividis = {
    0x00224e, 0x002e6a, 0x1a386f, 0x32436d, 0x434e6c, 0x535a6d, 0x61656f, 0x6f7073, 0x7d7c78,
    0x8c8878, 0x9b9476, 0xaba072, 0xbcae6c, 0xcdbb63, 0xdec958, 0xf0d846, 0xfee838};
constexpr std::array<std::uint32_t, 17> kBlueRed = {
    0x053061, 0x175290, 0x2a71b2, 0x3f8ec0, 0x6bacd1, 0x9bc9e0, 0xc2ddec, 0xe0ecf3, 0xf7f6f6,
    0xfbe5d8, 0xfbccb4, 0xf5aa89, 0xe48066, 0xd05548, 0xba2832, 0x930e26, 0x67001f};
constexpr std::array<std::uint32_t, 17> kYellowBrown = {
    0xffffe5, 0xfffbd0, 0xfff7bc, 0xfeeda6, 0xfee390, 0xfed36f, 0xfec34f, 0xfeae3b, 0xfe9829,
    0xf5841e, 0xeb6f14, 0xdb5d0b, 0xcb4b02, 0xb13f03, 0x983404, 0x7e2c05, 0x662506};
constexpr std::array<std::uint32_t, 17> kViridis = {
    0x440154, 0x48186a, 0x472d7b, 0x424086, 0x3b528b, 0x33638d, 0x2c728e, 0x26828e, 0x21918c,
    0x1fa088, 0x28ae80, 0x3fbc73, 0x5ec962, 0x84d44b, 0xaddc30, 0xd8e219, 0xfde725};

struct ColorMap {
  const char* name;
  std::span<const std::uint32_t> anchors;
};
/// In the order of the enumerators.
constexpr std::array<ColorMap, kColorMaps> kMaps = {
    {{"elevation", kCividis}, {"error", kBlueRed}, {"count", kYellowBrown}, {"magnitude", kViridis}}};

const ColorMap& map_of(Colors colors) { return kMaps.at(static_cast<std::size_t>(colors)); }

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
