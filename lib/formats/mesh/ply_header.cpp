// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh/ply_header.h"

#include <array>

#include "base/text/foreign_content.h"
#include "formats/mesh/mesh_text.h"

namespace landfall {
namespace {

struct TypeName {
  std::string_view name;
  NumberType type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", NumberType::int8},
                                               {"int8", NumberType::int8},
                                               {"uchar", NumberType::uint8},
                                               {"uint8", NumberType::uint8},
                                               {"short", NumberType::int16},
                                               {"int16", NumberType::int16},
                                               {"ushort", NumberType::uint16},
                                               {"uint16", NumberType::uint16},
                                               {"int", NumberType::int32},
                                               {"int32", NumberType::int32},
                                               {"uint", NumberType::uint32},
                                               {"uint32", NumberType::uint32},
                                               {"float", NumberType::float32},
                                               {"float32", NumberType::float32},
                                               {"double", NumberType::float64},
                                               {"float64", NumberType::float64}}};

NumberType number_type_of(MeshText& text) {
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
  PlyProperty property{"", NumberType::float64, std::nullopt};
  MeshText after_list = text;
  if (after_list.word_of_line() == "list") {
    text = after_list;
    property.length = number_type_of(text);
    if (*property.length >= NumberType::float32) text.fail("the length of a list has no integer type");
  }
  property.type = number_type_of(text);
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

}  // namespace landfall
