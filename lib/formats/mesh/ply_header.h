// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/text/stored_number.h"

namespace landfall {

struct PlyProperty {
  std::string name;
  NumberType type;
  std::optional<NumberType> length;  ///< type of a list's length
};

struct PlyElement {
  std::string name;
  std::int64_t count;
  std::vector<PlyProperty> properties = {};
};

enum class PlyEncoding { text, little_endian, big_endian };

/// The elements that a file declares, in their order.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::size_t end = 0;  ///< offset of the first element
};

/// Reads the header at the beginning of `bytes`. Throws FormatError, naming `name` and the line.
[[nodiscard]] PlyHeader read_ply_header(std::string_view bytes, const std::string& name);

}  // namespace landfall
