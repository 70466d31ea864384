// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshio/mesh_file.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <span>

#include "base/error.h"
#include "base/file_extension.h"
#include "base/hash.h"
#include "base/regular_file.h"
#include "meshio/mesh_text.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& path) {
  const std::string name = path.string();
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FormatError(name + ": cannot be read");
  std::string bytes(fs::file_size(path), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (stream.gcount() != static_cast<std::streamsize>(bytes.size()))
    throw FormatError(name + ": cannot be read completely");
  return bytes;
}

/// The point index in "7", "7/1", "7//3" or "-1": counted from 1, or backwards from the last point so far.
std::uint32_t obj_corner(std::string_view word, std::size_t point_count, const MeshText& text) {
  const std::int64_t number = text.integer(word.substr(0, word.find('/')));
  if (number == 0) text.fail("a facet names vertex 0; OBJ counts from 1");
  return point_number(number > 0 ? number - 1 : static_cast<std::int64_t>(point_count) + number,
                      [&](const std::string& what) { text.fail(what); });
}

/// The first word of the next line that is neither empty nor a comment.
std::string_view word_of_next_line(MeshText& text, const char* wanted) {
  for (;;) {
    if (text.at_end()) text.fail(std::string("ends before ") + wanted);
    const std::string_view word = text.word_of_line();
    if (!word.empty() && word.front() != '#') return word;
    text.skip_line();
  }
}

std::string_view off_keyword(MeshText& text) {
  const std::string_view keyword = word_of_next_line(text, "its keyword OFF");
  const bool known =
      keyword == "OFF" || keyword == "COFF" || keyword == "NOFF" || keyword == "CNOFF" || keyword == "STOFF";
  if (!known) text.fail("is not a supported OFF file: it begins with '" + shown_word(keyword) + "'");
  return keyword;
}

std::int64_t off_count(MeshText& text, std::string_view word) {
  const std::int64_t count = text.integer(word);
  if (count < 0) text.fail("a count of " + std::to_string(count));
  return count;
}

/// STL keywords may be in capitals; `keyword` must be in lower case.
bool is_keyword(std::string_view word, std::string_view keyword) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(word, keyword, {}, lower);
}

void expect_word(MeshText& text, std::string_view wanted) {
  const std::string_view word = text.word();
  if (!is_keyword(word, wanted))
    text.fail(word.empty() ? "ends before '" + std::string(wanted) + "'"
                           : "'" + shown_word(word) + "' where '" + std::string(wanted) + "' belongs");
}

void add_corner(PolygonSoup& soup, const Eigen::Vector3d& point) {
  soup.corners.push_back(static_cast<std::uint32_t>(soup.points.size()));
  soup.points.push_back(point);
}

PolygonSoup parse_ascii_stl(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(bytes, name);
  expect_word(text, "solid");
  text.skip_line();
  for (std::string_view word = text.word(); !is_keyword(word, "endsolid"); word = text.word()) {
    if (!is_keyword(word, "facet"))
      text.fail(word.empty() ? "ends before 'endsolid'" : "'" + shown_word(word) + "' is not a facet");
    text.skip_line();  // its normal
    expect_word(text, "outer");
    expect_word(text, "loop");
    for (int i = 0; i < 3; ++i) {
      expect_word(text, "vertex");
      add_corner(soup, text.point_of_line());
    }
    expect_word(text, "endloop");
    expect_word(text, "endfacet");
    soup.polygon_ends.push_back(soup.corners.size());
  }
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

}  // namespace

PolygonSoup parse_obj(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(bytes, name);
  for (text.join_lines(); !text.at_end(); text.skip_line()) {
    const std::string_view keyword = text.word_of_line();
    if (keyword == "v") soup.points.push_back(text.point_of_line());
    if (keyword != "f") continue;
    for (std::string_view word = text.word_of_line(); !word.empty() && word.front() != '#';
         word = text.word_of_line())
      soup.corners.push_back(obj_corner(word, soup.points.size(), text));
    soup.polygon_ends.push_back(soup.corners.size());
  }
  return soup;
}

PolygonSoup parse_off(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(bytes, name);
  static_cast<void>(off_keyword(text));
  const std::int64_t points = off_count(text, word_of_next_line(text, "its counts"));
  const std::int64_t facets = off_count(text, text.word_of_line());
  text.skip_line();
  for (std::int64_t i = 0; i < points; ++i, text.skip_line()) {
    const double x = text.number(word_of_next_line(text, "its last vertex"));
    const double y = text.number(text.word_of_line());
    soup.points.emplace_back(x, y, text.number(text.word_of_line()));
  }
  for (std::int64_t i = 0; i < facets; ++i, text.skip_line()) {
    const std::int64_t corners = off_count(text, word_of_next_line(text, "its last facet"));
    for (std::int64_t k = 0; k < corners; ++k)
      soup.corners.push_back(
          point_number(text.integer(text.word_of_line()), [&](const std::string& what) { text.fail(what); }));
    soup.polygon_ends.push_back(soup.corners.size());
  }
  return soup;
}

PolygonSoup parse_stl(std::string_view bytes, const std::string& name) {
  const bool says_solid = is_keyword(bytes.substr(0, 5), "solid");
  if (bytes.size() >= kStlHeader) {
    const std::size_t count = binary_stl_facets(bytes);
    const std::size_t held = (bytes.size() - kStlHeader) / kStlFacet;
    if (bytes.size() == kStlHeader + kStlFacet * count) return parse_binary_stl(bytes, count);
    if (!says_solid)
      throw FormatError(name + ": a binary STL file of " + std::to_string(count) + " facets, but there are " +
                        std::to_string(bytes.size()) + " bytes, enough for " + std::to_string(held));
  }
  if (!says_solid)
    throw FormatError(name + ": is not an STL file: it neither begins with 'solid' nor has a header");
  return parse_ascii_stl(bytes, name);
}

MeshFile read_mesh_file(const fs::path& path) {
  const std::string name = path.string();
  const std::string extension = file_extension(path);
  const auto parse = extension == ".obj"   ? parse_obj
                     : extension == ".ply" ? parse_ply
                     : extension == ".off" ? parse_off
                     : extension == ".stl" ? parse_stl
                                           : nullptr;
  if (parse == nullptr)
    throw FormatError(name + ": '" + shown_word(extension) +
                      "' is not a supported mesh format: use .obj, .ply, .off or .stl");
  const std::string bytes = read_bytes(path);
  return {parse(bytes, name), Hash().update(std::as_bytes(std::span(bytes))).hex()};
}

}  // namespace landfall
