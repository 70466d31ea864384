// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
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

/// 1234567 as "1,234,567".
[[nodiscard]] inline std::string grouped(std::int64_t count) {
  std::string text = std::to_string(count);
  const std::size_t first = count < 0 ? 1 : 0;
  for (std::size_t i = text.size(); i > first + 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

/// With three digits, for people: "0.000382", "11.1", "785321".
[[nodiscard]] inline std::string short_number(double value) {
  std::array<char, 64> text{};
  const bool is_whole = std::abs(value) >= 100 && std::abs(value) < 1e15;  // no exponent for counts
  std::snprintf(text.data(), text.size(), is_whole ? "%.0f" : "%.3g", value);
  return text.data();
}

/// 0.111 as "11.1 %".
[[nodiscard]] inline std::string percent_text(double fraction) { return short_number(100 * fraction) + " %"; }

/// Appends a number as PLY and LAS store it: little-endian, without padding.
template <class T>
void append_raw(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace landfall
