// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/ply_header.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/foreign_content.h"
#include "meshio/mesh_text.h"

namespace landfall {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", PlyType::int8},
                                               {"int8", PlyType::int8},
                                               {"uchar", PlyType::uint8},
                                               {"uint8", PlyType::uint8},
                                               {"short", PlyType::int16},
                                               {"int16", PlyType::int16},
                                               {"ushort", PlyType::uint16},
                                               {"uint16", PlyType::uint16},
                                               {"int", PlyType::int32},
                                               {"int32", PlyType::int32},
                                               {"uint", PlyType::uint32},
                                               {"uint32", PlyType::uint32},
                                               {"float", PlyType::float32},
                                               {"float32", PlyType::float32},
                                               {"double", PlyType::float64},
                                               {"float64", PlyType::float64}}};

template <class T>
double number_of(const unsigned char* bytes, bool is_big_endian) {
  std::array<unsigned char, sizeof(T)> own{};
  std::memcpy(own.data(), bytes, sizeof(T));
  if (is_big_endian) std::reverse(own.begin(), own.end());  // all supported machines are little-endian
  T value{};
  std::memcpy(&value, own.data(), sizeof(T));
  return static_cast<double>(value);
}

PlyType type_of(MeshText& text) {
  const std::string_view word = text.word_of_line();
  for (const TypeName& known : kTypeNames)
    if (known.name == word) return known.type;
  text.fail("'" + shown_word(word) + "' is not a PLY type");
}

PlyEncoding encoding_of(MeshText& text) {
  const std::string_view word = text.word_of_line();
  if (word == "ascii") return PlyEncoding::text;
  if (word == "binary_little_endian") return PlyEncoding::little_endian;
  if (word != "binary_big_endian") text.fail("'" + shown_word(word) + "' is not a PLY format");
  return PlyEncoding::big_endian;
}

void add_property(MeshText& text, std::vector<PlyElement>& elements) {
  if (elements.empty()) text.fail("a property before any element");
  PlyProperty property{"", PlyType::float64, std::nullopt};
  MeshText after_list = text;
  if (after_list.word_of_line() == "list") {
    text = after_list;
    property.length = type_of(text);
    if (*property.length >= PlyType::float32) text.fail("the length of a list has no integer type");
  }
  property.type = type_of(text);
  property.name = text.word_of_line();
  elements.back().properties.push_back(property);
}

}  // namespace

PlyHeader read_ply_header(std::string_view bytes, const std::string& name) {
  MeshText text(bytes, name, bytes.size() - without_byte_order_mark(bytes).size());
  if (text.word_of_line() != "ply") text.fail("is not a PLY file: it does not begin with 'ply'");
  PlyHeader header;
  bool has_format = false;
  for (;;) {
    text.skip_line();
    if (text.at_end()) text.fail("ends within the header");
    const std::string_view keyword = text.word_of_line();
    if (keyword == "end_header") break;
    if (keyword == "format") {
      header.encoding = encoding_of(text);
      has_format = true;
    } else if (keyword == "element") {
      const std::string element(text.word_of_line());
      const std::int64_t count = text.integer(text.word_of_line());
      if (count < 0) text.fail("a count of " + std::to_string(count));
      header.elements.push_back({element, count});
    } else if (keyword == "property") {
      add_property(text, header.elements);
    } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
      text.fail("'" + shown_word(keyword) + "' does not belong in a PLY header");
    }
  }
  if (!has_format) text.fail("the header names no format");
  text.skip_line();
  header.end = text.position();
  return header;
}

std::size_t size_of(PlyType type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes.at(static_cast<std::size_t>(type));
}

double stored_number(PlyType type, const void* bytes, bool is_big_endian) {
  const auto* const at = static_cast<const unsigned char*>(bytes);
  switch (type) {
    case PlyType::int8:
      return number_of<std::int8_t>(at, is_big_endian);
    case PlyType::uint8:
      return number_of<std::uint8_t>(at, is_big_endian);
    case PlyType::int16:
      return number_of<std::int16_t>(at, is_big_endian);
    case PlyType::uint16:
      return number_of<std::uint16_t>(at, is_big_endian);
    case PlyType::int32:
      return number_of<std::int32_t>(at, is_big_endian);
    case PlyType::uint32:
      return number_of<std::uint32_t>(at, is_big_endian);
    case PlyType::float32:
      return number_of<float>(at, is_big_endian);
    case PlyType::float64:
      return number_of<double>(at, is_big_endian);
  }
  return 0;
}

}  // namespace landfall
