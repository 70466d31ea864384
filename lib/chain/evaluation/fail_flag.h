// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "base/dictionary/tables/requirements.h"

namespace landfall {

/// The bit of a flag of schemas/dictionary/requirements.json.
[[nodiscard]] constexpr std::int8_t fail_bit(std::string_view name) {
  const auto& flags = dictionary::kFailFlags;
  return static_cast<std::int8_t>(std::ranges::find(flags, name, &dictionary::FailFlag::name)->bit);
}

/// Bits of the layer `fail`: why a bin or the footprint centred on it misses a requirement: fail_relative_x,
/// ...
enum FailFlag : std::int8_t {
#define LANDFALL_FLAG(name) fail_##name = fail_bit(#name),
  LANDFALL_FAIL_FLAGS(LANDFALL_FLAG)
#undef LANDFALL_FLAG
};

/// The requirement that a bin or footprint with the flag misses.
[[nodiscard]] constexpr const char* requirement_of(FailFlag flag) {
  return std::ranges::find(dictionary::kFailFlags, flag, &dictionary::FailFlag::bit)->requirement;
}

/// All flags, ascending by bit.
[[nodiscard]] constexpr auto fail_flags_by_bit() {
  auto flags = dictionary::kFailFlags;
  std::ranges::sort(flags, {}, &dictionary::FailFlag::bit);
  return flags;
}

inline void set_flag(std::int8_t& flags, FailFlag flag) { flags = static_cast<std::int8_t>(flags | flag); }

}  // namespace landfall
