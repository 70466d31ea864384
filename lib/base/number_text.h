// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <string>
#include <type_traits>

namespace landfall {

static_assert(std::endian::native == std::endian::little,
              "PLY and LAS are written in the byte order of this machine");

/// Appends the shortest text that reads back as the same value of its type; `nan` for any NaN.
template <class T>
void append_number(std::string& out, T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) {  // the sign of a NaN does not matter
      out += "nan";
      return;
    }
  }
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out.append(text.data(), static_cast<std::size_t>(end - text.data()));
}

/// The shortest text that reads back as the same double: 0.7, not 0.69999999999999996.
[[nodiscard]] inline std::string number_text(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// Appends a number as PLY and LAS store it: little-endian, without padding.
template <class T>
void append_raw(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace landfall
