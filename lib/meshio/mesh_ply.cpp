// SPDX-License-Identifier: GPL-3.0-or-later
// PLY: a header in text that declares elements and their properties, then the elements, as text or binary.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <vector>

#include "base/foreign_content.h"
#include "meshio/mesh_file.h"
#include "meshio/mesh_text.h"

namespace landfall {
namespace {

enum class Type { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr std::array<TypeName, 16> kTypeNames{{{"char", Type::int8},
                                               {"int8", Type::int8},
                                               {"uchar", Type::uint8},
                                               {"uint8", Type::uint8},
                                               {"short", Type::int16},
                                               {"int16", Type::int16},
                                               {"ushort", Type::uint16},
                                               {"uint16", Type::uint16},
                                               {"int", Type::int32},
                                               {"int32", Type::int32},
                                               {"uint", Type::uint32},
                                               {"uint32", Type::uint32},
                                               {"float", Type::float32},
                                               {"float32", Type::float32},
                                               {"double", Type::float64},
                                               {"float64", Type::float64}}};

std::size_t size_of(Type type) {
  constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes.at(static_cast<std::size_t>(type));
}

struct Property {
  std::string name;
  Type type;
  std::optional<Type> length;  ///< type of a list's length
};

struct Element {
  std::string name;
  std::int64_t count;
  std::vector<Property> properties = {};
};

enum class Encoding { text, little_endian, big_endian };

struct Header {
  Encoding encoding = Encoding::text;
  std::vector<Element> elements;
  std::size_t end = 0;  ///< offset of the first element
};

Type type_of(MeshText& text) {
  const std::string_view word = text.word_of_line();
  for (const TypeName& known : kTypeNames)
    if (known.name == word) return known.type;
  text.fail("'" + shown_word(word) + "' is not a PLY type");
}

Encoding encoding_of(MeshText& text) {
  const std::string_view word = text.word_of_line();
  if (word == "ascii") return Encoding::text;
  if (word == "binary_little_endian") return Encoding::little_endian;
  if (word != "binary_big_endian") text.fail("'" + shown_word(word) + "' is not a PLY format");
  return Encoding::big_endian;
}

void add_property(MeshText& text, std::vector<Element>& elements) {
  if (elements.empty()) text.fail("a property before any element");
  Property property{"", Type::float64, std::nullopt};
  MeshText after_list = text;
  if (after_list.word_of_line() == "list") {
    text = after_list;
    property.length = type_of(text);
    if (*property.length >= Type::float32) text.fail("the length of a list has no integer type");
  }
  property.type = type_of(text);
  property.name = text.word_of_line();
  elements.back().properties.push_back(property);
}

Header read_header(std::string_view bytes, const std::string& name) {
  MeshText text(bytes, name, bytes.size() - without_byte_order_mark(bytes).size());
  if (text.word_of_line() != "ply") text.fail("is not a PLY file: it does not begin with 'ply'");
  Header header;
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

/// Reads the numbers after the header in order.
class Values {
 public:
  Values(std::string_view bytes, const std::string& name, const Header& header)
      : bytes_(bytes), name_(name), encoding_(header.encoding), at_(header.end), text_(bytes, name, at_) {}

  double next(Type type) {
    if (encoding_ != Encoding::text) return next_binary(type);
    const std::string_view word = text_.word();
    if (word.empty()) fail("ends before its last element");
    return text_.number(word);
  }

  std::int64_t next_integer(Type type) {
    const double value = next(type);
    if (!(std::abs(value) < 0x1p53) || value != std::floor(value))
      fail("a length or number that is not an integer");
    return static_cast<std::int64_t>(value);
  }

  [[nodiscard]] std::size_t bytes_left() const {
    return bytes_.size() - (encoding_ == Encoding::text ? text_.position() : at_);
  }
  /// The least number of bytes of a value.
  [[nodiscard]] std::size_t min_size(Type type) const {
    return encoding_ == Encoding::text ? 1 : size_of(type);
  }

  /// Refuses what follows the last element.
  void require_end() {
    if (encoding_ == Encoding::text) return text_.require_end();
    if (bytes_left() > 0)
      fail(std::to_string(bytes_left()) + " bytes follow the last element that the header declares");
  }

  [[noreturn]] void fail(const std::string& what) const {
    if (encoding_ == Encoding::text) text_.fail(what);
    throw FormatError(name_ + ": byte " + std::to_string(at_) + ": " + what);
  }

 private:
  template <class T>
  [[nodiscard]] static double as(std::uint64_t bits) {
    T value{};
    std::memcpy(&value, &bits, sizeof value);  // the low bytes: all supported machines are little-endian
    return static_cast<double>(value);
  }

  double next_binary(Type type) {
    const std::size_t size = size_of(type);
    if (bytes_left() < size) fail("ends before its last element");
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t from = encoding_ == Encoding::big_endian ? i : size - 1 - i;
      bits = (bits << 8U) | static_cast<unsigned char>(bytes_[at_ + from]);
    }
    at_ += size;
    switch (type) {
      case Type::int8:
        return as<std::int8_t>(bits);
      case Type::uint8:
        return as<std::uint8_t>(bits);
      case Type::int16:
        return as<std::int16_t>(bits);
      case Type::uint16:
        return as<std::uint16_t>(bits);
      case Type::int32:
        return as<std::int32_t>(bits);
      case Type::uint32:
        return as<std::uint32_t>(bits);
      case Type::float32:
        return as<float>(bits);
      case Type::float64:
        return as<double>(bits);
    }
    return 0;
  }

  std::string_view bytes_;
  const std::string& name_;
  Encoding encoding_;
  std::size_t at_;
  MeshText text_;
};

/// Reads any property; the numbers of a list are appended to `numbers`.
double read_property(Values& values, const Property& property, std::vector<double>& numbers) {
  if (!property.length) return values.next(property.type);
  const std::int64_t length = values.next_integer(*property.length);
  if (length < 0 || static_cast<std::uint64_t>(length) > values.bytes_left() / values.min_size(property.type))
    values.fail("a list of " + std::to_string(length) + " numbers, more than the file has left");
  numbers.clear();
  for (std::int64_t i = 0; i < length; ++i) numbers.push_back(values.next(property.type));
  return 0;
}

void require_room(const Values& values, const Element& element) {
  std::size_t least = 0;
  for (const Property& property : element.properties)
    least += values.min_size(property.length.value_or(property.type));
  if (least > 0 && static_cast<std::uint64_t>(element.count) > values.bytes_left() / least)
    values.fail(std::to_string(element.count) + " elements '" + shown_word(element.name) +
                "', more than the file has left");
}

void add_polygon(const std::vector<double>& numbers, const Values& values, PolygonSoup& soup) {
  for (const double number : numbers) {
    const bool is_whole = std::abs(number) < 0x1p53 && number == std::floor(number);
    if (!is_whole) values.fail("the corner of a facet is not an integer");
    soup.corners.push_back(
        point_number(static_cast<std::int64_t>(number), [&](const std::string& what) { values.fail(what); }));
  }
  end_polygon(soup, [&](const std::string& what) { values.fail(what); });
}

/// The index of a property that the element must have, as a list or as a scalar.
std::size_t property_index(const Element& element, std::initializer_list<const char*> names, bool is_list,
                           const std::string& file) {
  for (const char* const name : names)
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].name == name && element.properties[i].length.has_value() == is_list) return i;
  throw FormatError(file + ": its element '" + element.name + "' has no " +
                    (is_list ? "list " : "property ") + *names.begin());
}

void read_vertices(Values& values, const Element& element, const std::string& name, PolygonSoup& soup) {
  const std::array<std::size_t, 3> indices{property_index(element, {"x"}, false, name),
                                           property_index(element, {"y"}, false, name),
                                           property_index(element, {"z"}, false, name)};
  std::vector<double> row(element.properties.size());
  std::vector<double> list;
  for (std::int64_t i = 0; i < element.count; ++i) {
    for (std::size_t p = 0; p < row.size(); ++p) row[p] = read_property(values, element.properties[p], list);
    soup.points.emplace_back(row[indices[0]], row[indices[1]], row[indices[2]]);
  }
}

/// read(numbers of the list) for each row of an element; its other properties are ignored.
template <class Read>
void read_lists(Values& values, const Element& element, const std::string& name, const Read& read) {
  const std::size_t corners = property_index(element, {"vertex_indices", "vertex_index"}, true, name);
  std::vector<double> list;
  for (std::int64_t i = 0; i < element.count; ++i)
    for (std::size_t p = 0; p < element.properties.size(); ++p) {
      static_cast<void>(read_property(values, element.properties[p], list));
      if (p == corners) read(list);
    }
}

/// The triangles of strips: each corner makes one with the two before it, whose order alternates so that all
/// face the same side. -1 ends a strip within the list.
void add_strips(const std::vector<double>& numbers, const Values& values, PolygonSoup& soup) {
  auto begin = numbers.begin();
  while (begin != numbers.end()) {
    const auto end = std::find(begin, numbers.end(), -1.0);
    if (end - begin == 1 || end - begin == 2)
      values.fail("a triangle strip of " + std::to_string(end - begin) + " corners");
    for (auto third = begin; third < end; ++third) {
      if (third - begin < 2) continue;
      const bool is_odd = (third - begin) % 2 == 1;
      add_polygon({third[is_odd ? -1 : -2], third[is_odd ? -2 : -1], *third}, values, soup);
    }
    begin = end == numbers.end() ? end : end + 1;
  }
}

void pass_over(Values& values, const Element& element) {
  std::vector<double> list;
  if (element.properties.empty()) return;
  for (std::int64_t i = 0; i < element.count; ++i)
    for (const Property& property : element.properties)
      static_cast<void>(read_property(values, property, list));
}

/// An element of another name. Lines and the like belong to the shape; a camera or a material does not.
void read_other(Values& values, const Element& element, const std::string& name, PolygonSoup& soup) {
  if (element.count == 0) return;
  for (const char* const shape : {"edge", "edges", "line", "polyline", "point", "range_grid", "cell"})
    if (element.name == shape)
      throw FormatError(name + ": has " + std::to_string(element.count) + " elements '" + element.name +
                        "'; vertex, face and tristrips are read: remove or convert them");
  pass_over(values, element);
  soup.unread.push_back("element '" + shown_word(element.name) + "' (" + std::to_string(element.count) + ")");
}

void require_single(const std::vector<Element>& elements, const std::string& name) {
  for (auto element = elements.begin(); element != elements.end(); ++element)
    if (std::any_of(elements.begin(), element, [&](const Element& e) { return e.name == element->name; }))
      throw FormatError(name + ": declares the element '" + shown_word(element->name) + "' twice");
}

}  // namespace

PolygonSoup parse_ply(std::string_view bytes, const std::string& name) {
  const Header header = read_header(bytes, name);
  require_single(header.elements, name);
  Values values(bytes, name, header);
  PolygonSoup soup;
  for (const Element& element : header.elements) {
    require_room(values, element);
    if (element.name == "vertex")
      read_vertices(values, element, name, soup);
    else if (element.name == "face")
      read_lists(values, element, name, [&](const auto& list) { add_polygon(list, values, soup); });
    else if (element.name == "tristrips")
      read_lists(values, element, name, [&](const auto& list) { add_strips(list, values, soup); });
    else
      read_other(values, element, name, soup);
  }
  values.require_end();
  return soup;
}

}  // namespace landfall
