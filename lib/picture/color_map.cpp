// SPDX-License-Identifier: GPL-3.0-or-later
#include "picture/color_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace landfall {
namespace {

constexpr std::array<Rgb, 17> kCividis = {{{0, 34, 78},
                                           {0, 46, 106},
                                           {26, 56, 111},
                                           {50, 67, 109},
                                           {67, 78, 108},
                                           {83, 90, 109},
                                           {97, 101, 111},
                                           {111, 112, 115},
                                           {125, 124, 120},
                                           {140, 136, 120},
                                           {155, 148, 118},
                                           {171, 160, 114},
                                           {188, 174, 108},
                                           {205, 187, 99},
                                           {222, 201, 88},
                                           {240, 216, 70},
                                           {254, 232, 56}}};
constexpr std::array<Rgb, 11> kBlueRed = {{{5, 48, 97},
                                           {32, 101, 171},
                                           {67, 147, 195},
                                           {144, 196, 221},
                                           {209, 229, 240},
                                           {247, 246, 246},
                                           {253, 219, 199},
                                           {243, 164, 129},
                                           {214, 96, 77},
                                           {177, 24, 43},
                                           {103, 0, 31}}};

std::uint8_t between(std::uint8_t a, std::uint8_t b, double part) {
  return static_cast<std::uint8_t>(std::lround(a + (b - a) * part));
}

}  // namespace

Rgb color_of(double fraction, Colors colors) {
  const std::span<const Rgb> anchors =
      colors == Colors::sequential ? std::span<const Rgb>(kCividis) : std::span<const Rgb>(kBlueRed);
  const double position = std::clamp(fraction, 0.0, 1.0) * static_cast<double>(anchors.size() - 1);
  const std::size_t below = std::min(static_cast<std::size_t>(position), anchors.size() - 2);
  const double part = position - static_cast<double>(below);
  const Rgb& a = anchors[below];
  const Rgb& b = anchors[below + 1];
  return {between(a.r, b.r, part), between(a.g, b.g, part), between(a.b, b.b, part)};
}

Rgb no_value_color(Colors colors) {
  return colors == Colors::sequential ? Rgb{255, 255, 255} : Rgb{70, 70, 70};
}

}  // namespace landfall
