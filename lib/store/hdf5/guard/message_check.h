// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "store/hdf5/guard/raw_file.h"

namespace landfall::h5 {

/// The properties of a datatype that the checks need.
struct StoredType {
  std::uint64_t size = 0;       ///< bytes of a value in the file
  bool in_heap = false;         ///< of variable length: the value is {count, heap address, index}
  std::uint64_t base_size = 1;  ///< of an element of variable length
};

/// Checks the body of a message of HDF5's object headers: its fields are in their ranges and within the body.
/// Each function throws Damaged otherwise.
[[nodiscard]] StoredType check_datatype(std::span<const std::byte> body);
/// The number of values per dimension; nothing for a space without values (null).
[[nodiscard]] std::optional<std::vector<std::uint64_t>> check_dataspace(std::span<const std::byte> body);
/// How many bytes of a chunk one stored byte can hold at most: 1 without compression, about 1,032 by deflate;
/// 0 if other filters leave it open.
[[nodiscard]] std::uint64_t check_filters(std::span<const std::byte> body);
/// The size of the fill value; 0 if there is none.
[[nodiscard]] std::uint64_t check_fill_value(std::span<const std::byte> body);
/// Checks where a group keeps its links (index: 8 bytes) or an object its attributes (2 bytes) outside its
/// header.
void check_storage(std::span<const std::byte> body, std::size_t index_size, std::uint64_t file_size);
void check_link(std::span<const std::byte> body, std::uint64_t file_size);

/// The place of a dataset's values.
struct StoredLayout {
  enum class Kind { compact, contiguous, chunked, other };
  Kind kind = Kind::other;  ///< other: a chunk index with checksums, or virtual
  std::uint64_t address = kNoAddress;
  std::uint64_t size = 0;            ///< of a contiguous layout
  std::vector<std::uint64_t> chunk;  ///< per dimension, and the size of a value
  std::vector<std::byte> values;     ///< of a compact layout
};
[[nodiscard]] StoredLayout check_layout(std::span<const std::byte> body);

struct StoredAttribute {
  StoredType type;
  std::uint64_t count = 0;
  std::span<const std::byte> values;
};
/// Nothing for an attribute whose type or space is stored elsewhere.
[[nodiscard]] std::optional<StoredAttribute> check_attribute(std::span<const std::byte> body);

/// The product of sizes. Throws Damaged if it has more than 64 bits.
[[nodiscard]] std::uint64_t checked_product(const std::vector<std::uint64_t>& sizes);

}  // namespace landfall::h5
