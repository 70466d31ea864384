// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "store/hdf5/guard/raw_file.h"

namespace landfall::h5 {

/// The messages of HDF5's object headers that are checked; the numbers are those of the file format.
enum class MessageType : std::uint16_t {
  dataspace = 0x1,
  link_info = 0x2,
  datatype = 0x3,
  old_fill_value = 0x4,
  fill_value = 0x5,
  link = 0x6,
  layout = 0x8,
  filters = 0xb,
  attribute = 0xc,
  continuation = 0x10,
  symbol_table = 0x11,
  attribute_info = 0x15,
};

struct HeaderMessage {
  MessageType type;
  bool shared;  ///< the body is stored elsewhere
  std::vector<std::byte> body;
};

/// All messages of the object whose header is at `address`, without the continuations. Throws Damaged unless
/// the header is of version 1 or 2 and consistent.
[[nodiscard]] std::vector<HeaderMessage> messages_at(const RawFile& file, std::uint64_t address);

}  // namespace landfall::h5
