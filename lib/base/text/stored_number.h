// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace landfall {

/// The types of the numbers in binary PLY and PCD files.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64, int64, uint64 };

[[nodiscard]] inline std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 10> kSizes{1, 1, 2, 2, 4, 4, 4, 8, 8, 8};
  return kSizes.at(static_cast<std::size_t>(type));
}

/// The number in sizeof(T) bytes.
template <class T, class Result = double>
[[nodiscard]] Result stored_number_of(const void* bytes, bool is_big_endian) {
  std::array<unsigned char, sizeof(T)> own{};
  std::memcpy(own.data(), bytes, sizeof(T));
  if (is_big_endian) std::reverse(own.begin(), own.end());  // all supported machines are little-endian
  T value{};
  std::memcpy(&value, own.data(), sizeof(T));
  return static_cast<Result>(value);
}

/// The number in size_of(type) bytes.
[[nodiscard]] inline double stored_number(NumberType type, const void* bytes, bool is_big_endian) {
  switch (type) {
    case NumberType::int8:
      return stored_number_of<std::int8_t>(bytes, is_big_endian);
    case NumberType::uint8:
      return stored_number_of<std::uint8_t>(bytes, is_big_endian);
    case NumberType::int16:
      return stored_number_of<std::int16_t>(bytes, is_big_endian);
    case NumberType::uint16:
      return stored_number_of<std::uint16_t>(bytes, is_big_endian);
    case NumberType::int32:
      return stored_number_of<std::int32_t>(bytes, is_big_endian);
    case NumberType::uint32:
      return stored_number_of<std::uint32_t>(bytes, is_big_endian);
    case NumberType::float32:
      return stored_number_of<float>(bytes, is_big_endian);
    case NumberType::float64:
      return stored_number_of<double>(bytes, is_big_endian);
    case NumberType::int64:
      return stored_number_of<std::int64_t>(bytes, is_big_endian);
    case NumberType::uint64:
      return stored_number_of<std::uint64_t>(bytes, is_big_endian);
  }
  return 0;
}

}  // namespace landfall
