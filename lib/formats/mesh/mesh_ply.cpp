// SPDX-License-Identifier: GPL-3.0-or-later
// PLY: a header in text that declares elements and their properties, then the elements, as text or binary.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "formats/mesh/mesh_file.h"
#include "formats/mesh/mesh_text.h"
#include "formats/mesh/ply_header.h"

namespace landfall {
namespace {

/// Reads the numbers after the header in order.
class Values {
 public:
  Values(std::string_view bytes, const std::string& name, const PlyHeader& header)
      : bytes_(bytes), name_(name), encoding_(header.encoding), at_(header.end), text_(bytes, name, at_) {}

  double next(NumberType type) {
    if (encoding_ != PlyEncoding::text) return next_binary(type);
    const std::string_view word = text_.word();
    if (word.empty()) fail("ends before its last element");
    return text_.number(word);
  }

  std::int64_t next_integer(NumberType type) {
    const double value = next(type);
    if (!(std::abs(value) < 0x1p53) || value != std::floor(value))
      fail("a length or number that is not an integer");
    return static_cast<std::int64_t>(value);
  }

  [[nodiscard]] std::size_t bytes_left() const {
    return bytes_.size() - (encoding_ == PlyEncoding::text ? text_.position() : at_);
  }
  /// The least number of bytes of a value.
  [[nodiscard]] std::size_t min_size(NumberType type) const {
    return encoding_ == PlyEncoding::text ? 1 : size_of(type);
  }

  /// Refuses text after the last element.
  void require_end() {
    if (encoding_ == PlyEncoding::text) return text_.require_end();
    if (bytes_left() > 0)
      fail(std::to_string(bytes_left()) + " bytes follow the last element that the header declares");
  }

  [[noreturn]] void fail(const std::string& what) const {
    if (encoding_ == PlyEncoding::text) text_.fail(what);
    throw FormatError(name_ + ": byte " + std::to_string(at_) + ": " + what);
  }

 private:
  double next_binary(NumberType type) {
    const std::size_t size = size_of(type);
    if (bytes_left() < size) fail("ends before its last element");
    const double value = stored_number(type, bytes_.data() + at_, encoding_ == PlyEncoding::big_endian);
    at_ += size;
    return value;
  }

  std::string_view bytes_;
  const std::string& name_;
  PlyEncoding encoding_;
  std::size_t at_;
  MeshText text_;
};

/// Reads any property; the numbers of a list are appended to `numbers`.
double read_property(Values& values, const PlyProperty& property, std::vector<double>& numbers) {
  if (!property.length) return values.next(property.type);
  const std::int64_t length = values.next_integer(*property.length);
  if (length < 0 || static_cast<std::uint64_t>(length) > values.bytes_left() / values.min_size(property.type))
    values.fail("a list of " + std::to_string(length) + " numbers, more than the file has left");
  numbers.clear();
  for (std::int64_t i = 0; i < length; ++i) numbers.push_back(values.next(property.type));
  return 0;
}

void require_room(const Values& values, const PlyElement& element) {
  std::size_t minimum = 0;
  for (const PlyProperty& property : element.properties)
    minimum += values.min_size(property.length.value_or(property.type));
  if (minimum > 0 && static_cast<std::uint64_t>(element.count) > values.bytes_left() / minimum)
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
std::size_t property_index(const PlyElement& element, std::initializer_list<const char*> names, bool is_list,
                           const std::string& file) {
  for (const char* const name : names)
    for (std::size_t i = 0; i < element.properties.size(); ++i)
      if (element.properties[i].name == name && element.properties[i].length.has_value() == is_list) return i;
  throw FormatError(file + ": its element '" + element.name + "' has no " +
                    (is_list ? "list " : "property ") + *names.begin());
}

void read_vertices(Values& values, const PlyElement& element, const std::string& name, PolygonSoup& soup) {
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
void read_lists(Values& values, const PlyElement& element, const std::string& name, const Read& read) {
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

void pass_over(Values& values, const PlyElement& element) {
  std::vector<double> list;
  if (element.properties.empty()) return;
  for (std::int64_t i = 0; i < element.count; ++i)
    for (const PlyProperty& property : element.properties)
      static_cast<void>(read_property(values, property, list));
}

/// An element of another name. Lines and the like belong to the shape; a camera or a material does not.
void read_other(Values& values, const PlyElement& element, const std::string& name, PolygonSoup& soup) {
  if (element.count == 0) return;
  for (const char* const shape : {"edge", "edges", "line", "polyline", "point", "range_grid", "cell"})
    if (element.name == shape)
      throw FormatError(name + ": has element '" + element.name + "' (count " +
                        std::to_string(element.count) +
                        "); only vertex, face and tristrips can be read: remove or convert it");
  pass_over(values, element);
  soup.unread.push_back("element '" + shown_word(element.name) + "' (" + std::to_string(element.count) + ")");
}

void require_single(const std::vector<PlyElement>& elements, const std::string& name) {
  for (auto element = elements.begin(); element != elements.end(); ++element)
    if (std::any_of(elements.begin(), element, [&](const PlyElement& e) { return e.name == element->name; }))
      throw FormatError(name + ": declares the element '" + shown_word(element->name) + "' twice");
}

}  // namespace

PolygonSoup parse_ply(std::string_view bytes, const std::string& name) {
  const PlyHeader header = read_ply_header(bytes, name);
  require_single(header.elements, name);
  Values values(bytes, name, header);
  PolygonSoup soup;
  for (const PlyElement& element : header.elements) {
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
