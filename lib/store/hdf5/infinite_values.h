// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <string>

#include "base/core/error.h"
#include "store/hdf5/h5.h"

namespace landfall {

template <class T>
[[nodiscard]] bool is_infinite(T value) {
  return std::abs(value) > std::numeric_limits<T>::max();
}

/// Whether one of the values, of type T, is infinite.
template <class T>
[[nodiscard]] bool holds_infinity(std::span<const std::byte> values) {
  bool found = false;
  for (std::size_t i = 0; i + sizeof(T) <= values.size(); i += sizeof(T)) {
    T value;
    std::memcpy(&value, values.data() + i, sizeof value);
    found |= is_infinite(value);
  }
  return found;
}

/// Throws FormatError, naming `what` ("column x_est"), if values to be written are infinite: then an input is
/// so large that the result overflows. NaN is valid, it means "none".
inline void require_no_infinity(std::span<const std::byte> values, h5::Type type, const std::string& what) {
  const bool found = (type == h5::Type::float64 && holds_infinity<double>(values)) ||
                     (type == h5::Type::float32 && holds_infinity<float>(values));
  if (found)
    throw FormatError(
        what + " would hold infinite values: a value of the configuration or of an input is too large");
}

}  // namespace landfall
