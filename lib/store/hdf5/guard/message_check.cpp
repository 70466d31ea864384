// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/message_check.h"

#include <algorithm>

namespace landfall::h5 {
namespace {

constexpr std::uint64_t kMaxRank = 32;
constexpr std::uint64_t kMaxMembers = 4096;
constexpr int kMaxTypeLevels = 8;

constexpr std::uint64_t padded(std::uint64_t size) { return (size + 7) / 8 * 8; }

/// The name of a member, with its zero; padded to 8 bytes before version 3.
void skip_name(ByteCursor& cursor, std::uint64_t version) {
  const std::size_t begin = cursor.position();
  while (cursor.number(1) != 0) {
  }
  const std::size_t size = cursor.position() - begin;
  if (version < 3) cursor.skip(padded(size) - size);
}

enum class TypeClass : std::uint64_t {
  fixed_point,
  floating_point,
  time,
  string,
  bit_field,
  opaque,
  compound,
  reference,
  enumeration,
  variable_length,
  array,
};

struct TypeHead {
  TypeClass type_class;
  std::uint64_t version;
  std::uint64_t bits;
  std::uint64_t size;
};

TypeHead head_of(ByteCursor& cursor) {
  const std::uint64_t first = cursor.number(1);
  TypeHead head{static_cast<TypeClass>(first & 0xfU), first >> 4U, cursor.number(3), cursor.number(4)};
  require_sound(head.version >= 1 && head.version <= 4 && head.size > 0);
  return head;
}

StoredType check_type(ByteCursor& cursor, int level);

void check_float(ByteCursor& cursor, const TypeHead& head) {
  const std::uint64_t bits = 8 * head.size;
  const std::uint64_t offset = cursor.number(2);
  const std::uint64_t precision = cursor.number(2);
  const std::uint64_t exponent = cursor.number(1);
  const std::uint64_t exponent_size = cursor.number(1);
  const std::uint64_t mantissa = cursor.number(1);
  const std::uint64_t mantissa_size = cursor.number(1);
  cursor.skip(4);
  require_sound(head.size <= 32 && precision > 0 && offset + precision <= bits);
  require_sound(exponent_size > 0 && exponent + exponent_size <= precision);
  require_sound(mantissa_size > 0 && mantissa + mantissa_size <= precision);
  require_sound((head.bits >> 8U & 0xffU) < precision);  // sign
}

void check_integer(ByteCursor& cursor, const TypeHead& head) {
  const std::uint64_t offset = cursor.number(2);
  const std::uint64_t precision = cursor.number(2);
  require_sound(head.size <= 32 && precision > 0 && offset + precision <= 8 * head.size);
}

void check_members(ByteCursor& cursor, const TypeHead& head, int level) {
  const std::uint64_t count = head.bits & 0xffffU;
  require_sound(count > 0 && count <= kMaxMembers);
  std::size_t offset_size = 4;
  if (head.version >= 3)
    for (offset_size = 1; offset_size < 4 && head.size >> 8 * offset_size != 0;) ++offset_size;
  for (std::uint64_t i = 0; i < count; ++i) {
    skip_name(cursor, head.version);
    const std::uint64_t offset = cursor.number(offset_size);
    if (head.version == 1) cursor.skip(28);  // its array dimensions
    const std::uint64_t size = check_type(cursor, level + 1).size;
    require_sound(offset <= head.size && size <= head.size - offset);
  }
}

void check_enumeration(ByteCursor& cursor, const TypeHead& head, int level) {
  const std::uint64_t count = head.bits & 0xffffU;
  require_sound(check_type(cursor, level + 1).size == head.size && count <= kMaxMembers);
  for (std::uint64_t i = 0; i < count; ++i) skip_name(cursor, head.version);
  cursor.skip(count * head.size);
}

void check_array(ByteCursor& cursor, const TypeHead& head, int level) {
  const std::uint64_t rank = cursor.number(1);
  require_sound(rank > 0 && rank <= kMaxRank);
  if (head.version < 3) cursor.skip(3);
  std::vector<std::uint64_t> sizes(rank);
  for (std::uint64_t& size : sizes) size = cursor.number(4);
  if (head.version < 3) cursor.skip(4 * rank);
  sizes.push_back(check_type(cursor, level + 1).size);
  require_sound(checked_product(sizes) == head.size);
}

StoredType check_type(ByteCursor& cursor, int level) {
  require_sound(level < kMaxTypeLevels);
  const TypeHead head = head_of(cursor);
  switch (head.type_class) {
    case TypeClass::fixed_point:
    case TypeClass::bit_field:
      check_integer(cursor, head);
      break;
    case TypeClass::floating_point:
      check_float(cursor, head);
      break;
    case TypeClass::time:
      cursor.skip(2);
      break;
    case TypeClass::string:
      break;
    case TypeClass::opaque:
      cursor.skip(head.bits & 0xffU);
      break;
    case TypeClass::compound:
      check_members(cursor, head, level);
      break;
    case TypeClass::reference:
      require_sound(head.size <= 16);
      break;
    case TypeClass::enumeration:
      check_enumeration(cursor, head, level);
      break;
    case TypeClass::variable_length:
      require_sound(head.size == 16);
      return {head.size, true, check_type(cursor, level + 1).size};
    case TypeClass::array:
      check_array(cursor, head, level);
      break;
    default:
      throw Damaged();
  }
  return {head.size, false, 1};
}

StoredLayout check_old_layout(ByteCursor& cursor) {
  const std::uint64_t dimensions = cursor.number(1);
  const std::uint64_t kind = cursor.number(1);
  cursor.skip(5);
  StoredLayout layout;
  if (kind > 0) layout.address = cursor.number(8);
  require_sound(dimensions > 0 && dimensions <= kMaxRank + 1 && kind <= 2);
  std::vector<std::uint64_t> sizes(dimensions);
  for (std::uint64_t& size : sizes) size = cursor.number(4);
  if (kind == 0) {
    const auto values = cursor.take(cursor.number(4));
    layout.kind = StoredLayout::Kind::compact;
    layout.values.assign(values.begin(), values.end());
  } else if (kind == 1) {
    layout.kind = StoredLayout::Kind::contiguous;
    layout.size = checked_product(sizes);
  } else {
    layout.kind = StoredLayout::Kind::chunked;
    layout.chunk = std::move(sizes);
  }
  return layout;
}

}  // namespace

std::uint64_t checked_product(const std::vector<std::uint64_t>& sizes) {
  std::uint64_t product = 1;
  for (const std::uint64_t size : sizes) require_sound(!__builtin_mul_overflow(product, size, &product));
  return product;
}

StoredType check_datatype(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  return check_type(cursor, 0);
}

std::optional<std::vector<std::uint64_t>> check_dataspace(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  const std::uint64_t version = cursor.number(1);
  const std::uint64_t rank = cursor.number(1);
  const std::uint64_t flags = cursor.number(1);
  const std::uint64_t kind = cursor.number(1);  // of version 2
  if (version == 1) cursor.skip(4);
  require_sound((version == 1 || (version == 2 && kind <= 2)) && rank <= kMaxRank && flags <= 3);
  std::vector<std::uint64_t> sizes(rank);
  for (std::uint64_t& size : sizes) size = cursor.number(8);
  if ((flags & 1U) != 0)
    for (const std::uint64_t size : sizes) require_sound(size <= cursor.number(8));
  if (version == 2 && kind == 2) return std::nullopt;
  return sizes;
}

std::uint64_t check_filters(std::span<const std::byte> body) {
  constexpr std::uint64_t kDeflate = 1;
  constexpr std::uint64_t kShuffle = 2;
  constexpr std::uint64_t kFletcher32 = 3;
  constexpr std::uint64_t kDeflateRatio = 1040;
  std::uint64_t ratio = 1;
  ByteCursor cursor(body);
  const std::uint64_t version = cursor.number(1);
  const std::uint64_t count = cursor.number(1);
  require_sound((version == 1 || version == 2) && count <= 32);
  if (version == 1) cursor.skip(6);
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t id = cursor.number(2);
    const bool has_name = version == 1 || id >= 256;
    const std::uint64_t name = has_name ? cursor.number(2) : 0;
    cursor.skip(2);
    const std::uint64_t values = cursor.number(2);
    require_sound(version == 2 || name % 8 == 0);
    const auto text = cursor.take(name);
    require_sound(name == 0 || std::ranges::count(text, std::byte{0}) > 0);
    cursor.skip(4 * values);
    if (version == 1 && values % 2 == 1) cursor.skip(4);
    if (id == kDeflate)
      ratio = ratio == 1 ? kDeflateRatio : 0;
    else if (id != kShuffle && id != kFletcher32)
      ratio = 0;
  }
  return ratio;
}

std::uint64_t check_fill_value(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  const std::uint64_t version = cursor.number(1);
  require_sound(version >= 1 && version <= 3);
  bool has_size = true;
  if (version == 3) {
    has_size = (cursor.number(1) & 0x20U) != 0;
  } else {
    cursor.skip(2);
    has_size = cursor.number(1) != 0 || version == 1;
  }
  const std::uint64_t size = has_size ? cursor.number(4) : 0;
  if (size == 0xffffffffU && version < 3) return 0;  // undefined
  cursor.skip(size);
  return size;
}

void check_storage(std::span<const std::byte> body, std::size_t index_size, std::uint64_t file_size) {
  ByteCursor cursor(body);
  require_sound(cursor.number(1) == 0);
  const std::uint64_t flags = cursor.number(1);
  require_sound(flags <= 3);
  if ((flags & 1U) != 0) cursor.skip(index_size);
  const std::uint64_t heap = cursor.number(8);
  for (int trees = (flags & 2U) != 0 ? 2 : 1; trees > 0; --trees) {
    const std::uint64_t tree = cursor.number(8);
    require_sound(heap == kNoAddress ? tree == kNoAddress : std::max(heap, tree) < file_size);
  }
}

void check_link(std::span<const std::byte> body, std::uint64_t file_size) {
  ByteCursor cursor(body);
  require_sound(cursor.number(1) == 1);
  const std::uint64_t flags = cursor.number(1);
  const std::uint64_t kind = (flags & 8U) != 0 ? cursor.number(1) : 0;
  if ((flags & 4U) != 0) cursor.skip(8);
  const std::uint64_t character_set = (flags & 16U) != 0 ? cursor.number(1) : 0;
  require_sound(flags <= 0x1f && (kind <= 1 || kind >= 64) && character_set <= 1);
  const std::uint64_t name = cursor.number(std::size_t{1} << (flags & 3U));
  require_sound(name > 0);
  cursor.skip(name);
  if (kind == 0)
    require_sound(cursor.number(8) < file_size);
  else
    cursor.skip(cursor.number(2));
}

StoredLayout check_layout(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  const std::uint64_t version = cursor.number(1);
  require_sound(version >= 1 && version <= 4);
  if (version < 3) return check_old_layout(cursor);
  StoredLayout layout;
  const std::uint64_t kind = cursor.number(1);
  require_sound(kind <= (version == 3 ? 2U : 3U));
  if (kind == 0) {
    const auto values = cursor.take(cursor.number(2));
    layout.kind = StoredLayout::Kind::compact;
    layout.values.assign(values.begin(), values.end());
  } else if (kind == 1) {
    layout.kind = StoredLayout::Kind::contiguous;
    layout.address = cursor.number(8);
    layout.size = cursor.number(8);
  } else if (version == 3) {
    layout.kind = StoredLayout::Kind::chunked;
    const std::uint64_t dimensions = cursor.number(1);
    require_sound(dimensions >= 2 && dimensions <= kMaxRank + 1);
    layout.address = cursor.number(8);
    layout.chunk.resize(dimensions);
    for (std::uint64_t& size : layout.chunk) size = cursor.number(4);
  }
  return layout;
}

std::optional<StoredAttribute> check_attribute(std::span<const std::byte> body) {
  ByteCursor cursor(body);
  const std::uint64_t version = cursor.number(1);
  const std::uint64_t flags = cursor.number(1);
  const std::uint64_t name = cursor.number(2);
  const std::uint64_t type_size = cursor.number(2);
  const std::uint64_t space_size = cursor.number(2);
  require_sound(version >= 1 && version <= 3 && (version == 1 || flags <= 3) && name > 0);
  if (version == 3) cursor.skip(1);
  const auto stored = [version](std::uint64_t size) { return version == 1 ? padded(size) : size; };
  const auto text = cursor.take(stored(name));
  require_sound(text[name - 1] == std::byte{0});
  const auto type_bytes = cursor.take(stored(type_size));
  const auto space_bytes = cursor.take(stored(space_size));
  if (version > 1 && flags != 0) return std::nullopt;
  const StoredType type = check_datatype(type_bytes);
  const auto space = check_dataspace(space_bytes);
  StoredAttribute attribute{type, space ? checked_product(*space) : 0, {}};
  attribute.values = cursor.take(checked_product({attribute.count, type.size}));
  return attribute;
}

}  // namespace landfall::h5
