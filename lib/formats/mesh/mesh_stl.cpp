// SPDX-License-Identifier: GPL-3.0-or-later
// STL: text, one solid or several, or binary.
#include <algorithm>
#include <cstring>

#include "base/text/foreign_content.h"
#include "formats/mesh/mesh_file.h"
#include "formats/mesh/mesh_text.h"

namespace landfall {
namespace {

/// STL keywords may be in capitals; `keyword` must be in lower case.
bool is_keyword(std::string_view word, std::string_view keyword) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(word, keyword, {}, lower);
}

void require_word(const MeshText& text, std::string_view word, std::string_view wanted) {
  if (!is_keyword(word, wanted))
    text.fail(word.empty() ? "ends before '" + std::string(wanted) + "'"
                           : "'" + shown_word(word) + "' where '" + std::string(wanted) + "' belongs");
}

void expect_word(MeshText& text, std::string_view wanted) { require_word(text, text.word(), wanted); }

void add_corner(PolygonSoup& soup, const Eigen::Vector3d& point) {
  soup.corners.push_back(static_cast<std::uint32_t>(soup.points.size()));
  soup.points.push_back(point);
}

/// From after "facet" to "endfacet".
void read_stl_facet(MeshText& text, PolygonSoup& soup) {
  text.skip_line();  // its normal
  expect_word(text, "outer");
  expect_word(text, "loop");
  std::string_view word = text.word();
  for (int corners = 0; corners < 3 || is_keyword(word, "vertex"); ++corners, word = text.word()) {
    require_word(text, word, "vertex");
    add_corner(soup, text.point_of_line());
  }
  require_word(text, word, "endloop");
  expect_word(text, "endfacet");
  soup.polygon_ends.push_back(soup.corners.size());
}

PolygonSoup parse_ascii_stl(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(bytes, name);
  std::string_view solid = text.word();
  do {
    require_word(text, solid, "solid");
    text.skip_line();
    for (std::string_view word = text.word(); !is_keyword(word, "endsolid"); word = text.word()) {
      if (!is_keyword(word, "facet"))
        text.fail(word.empty() ? "ends before 'endsolid'" : "'" + shown_word(word) + "' is not a facet");
      read_stl_facet(text, soup);
    }
    text.skip_line();
    solid = text.word();
  } while (!solid.empty());
  return soup;
}

float little_endian_float(const char* bytes) {
  std::uint32_t bits = 0;
  for (unsigned i = 4; i-- > 0;) bits = (bits << 8U) | static_cast<unsigned char>(bytes[i]);
  float value = 0;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

constexpr std::size_t kStlHeader = 84;  // 80 bytes of comment, the number of facets
constexpr std::size_t kStlFacet = 50;   // normal, three corners, two bytes more

std::size_t binary_stl_facets(std::string_view bytes) {
  std::size_t count = 0;
  for (std::size_t i = 4; i-- > 0;) count = (count << 8U) | static_cast<unsigned char>(bytes[80 + i]);
  return count;
}

PolygonSoup parse_binary_stl(std::string_view bytes, std::size_t count) {
  PolygonSoup soup;
  for (std::size_t facet = 0; facet < count; ++facet) {
    const char* at = bytes.data() + kStlHeader + kStlFacet * facet + 12;
    for (int corner = 0; corner < 3; ++corner, at += 12)
      add_corner(soup, {little_endian_float(at), little_endian_float(at + 4), little_endian_float(at + 8)});
    soup.polygon_ends.push_back(soup.corners.size());
  }
  return soup;
}

void require_no_foreign(std::string_view bytes, const std::string& name) {
  if (const std::string foreign = foreign_content(bytes); !foreign.empty())
    throw FormatError(name + ": " + foreign);
}

}  // namespace

PolygonSoup parse_stl(std::string_view bytes, const std::string& name) {
  const std::string_view text = without_byte_order_mark(bytes);
  const std::size_t begin = std::min(text.find_first_not_of(" \t\r\n"), text.size());
  // A binary file may begin with "solid" too, but only a binary one has zeros.
  const bool is_text =
      is_keyword(text.substr(begin, 5), "solid") && text.find('\0') == std::string_view::npos;
  if (bytes.size() >= kStlHeader) {
    const std::size_t count = binary_stl_facets(bytes);
    const std::size_t held = (bytes.size() - kStlHeader) / kStlFacet;
    if (bytes.size() == kStlHeader + kStlFacet * count) return parse_binary_stl(bytes, count);
    if (!is_text) require_no_foreign(bytes, name);
    if (!is_text)
      throw FormatError(name + ": a binary STL file of " + std::to_string(count) + " facets, but there are " +
                        std::to_string(bytes.size()) + " bytes, enough for " + std::to_string(held));
  }
  if (!is_text) require_no_foreign(bytes, name);
  if (!is_text)
    throw FormatError(name + ": is not an STL file: it neither begins with 'solid' nor has a header");
  return parse_ascii_stl(text, name);
}

}  // namespace landfall
