// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstring>
#include <string>

namespace landfall {

static_assert(std::endian::native == std::endian::little, "numbers go to PLY and LAS as they are in memory");

/// Appends a number as PLY and LAS hold it: little endian, without padding.
template <class T>
void append_raw(std::string& out, T value) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

}  // namespace landfall
