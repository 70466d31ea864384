// SPDX-License-Identifier: GPL-3.0-or-later
// Wavefront OBJ (Alias|Wavefront, Object Files, version 3.0).
#include <algorithm>
#include <array>
#include <span>

#include "base/text/foreign_content.h"
#include "base/text/number_text.h"
#include "formats/mesh/mesh_file.h"
#include "formats/mesh/mesh_text.h"

namespace landfall {
namespace {

/// Keywords without a surface: texture, normals, groups and how the object is drawn.
constexpr std::array<std::string_view, 17> kIgnored = {
    "vt",     "vn",    "g",        "s",        "o",          "mg",        "usemtl", "mtllib", "usemap",
    "maplib", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "ctech",  "stech"};

/// Curves and surfaces, and what belongs to them.
constexpr std::array<std::string_view, 16> kFreeForm = {"vp",    "cstype", "deg",  "bmat", "step", "curv",
                                                        "curv2", "surf",   "parm", "trim", "hole", "scrv",
                                                        "sp",    "end",    "con",  "res"};

bool is_in(std::span<const std::string_view> keywords, std::string_view word) {
  return std::ranges::find(keywords, word) != keywords.end();
}

/// The point index in "7", "7/1", "7//3" or "-1": counted from 1, or backwards from the last point so far.
std::uint32_t obj_corner(std::string_view word, std::size_t point_count, const MeshText& text) {
  const std::int64_t number = text.integer(word.substr(0, word.find('/')));
  if (number == 0) text.fail("a facet names vertex 0; OBJ counts from 1");
  return point_number(number > 0 ? number - 1 : static_cast<std::int64_t>(point_count) + number,
                      [&](const std::string& what) { text.fail(what); });
}

/// x y z, then nothing, a weight, a colour, or both.
void read_obj_vertex(MeshText& text, PolygonSoup& soup) {
  soup.points.push_back(text.point_of_line());
  const std::vector<double> rest = text.numbers_of_line();
  if (rest.size() == 2 || rest.size() > 4)
    text.fail("a vertex of " + std::to_string(3 + rest.size()) + " numbers, not 3, 4, 6 or 7");
  if (rest.size() == 1 && rest[0] != 1)
    text.fail("a vertex with the weight " + number_text(rest[0]) +
              "; programs disagree on its place: write 3 numbers");
}

void read_obj_facet(MeshText& text, PolygonSoup& soup) {
  for (std::string_view word = text.word_of_line(); !word.empty() && word.front() != '#';
       word = text.word_of_line())
    soup.corners.push_back(obj_corner(word, soup.points.size(), text));
  end_polygon(soup, [&](const std::string& what) { text.fail(what); });
}

[[noreturn]] void refuse_keyword(std::string_view keyword, const MeshText& text) {
  if (keyword == "p" || keyword == "l")
    text.fail(std::string("a ") + (keyword == "p" ? "point" : "line") + " element '" + std::string(keyword) +
              "'; a terrain has facets only: remove it");
  if (is_in(kFreeForm, keyword))
    text.fail("'" + std::string(keyword) + "' is free-form geometry; export facets (lines f) instead");
  text.fail("'" + shown_word(keyword) +
            "' is not an OBJ keyword that is read: v and f are, vt, vn, g, o, s and "
            "materials are ignored");
}

}  // namespace

PolygonSoup parse_obj(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(without_byte_order_mark(bytes), name);
  for (text.join_lines(); !text.at_end(); text.skip_line()) {
    const std::string_view keyword = text.word_of_line();
    if (keyword == "v")
      read_obj_vertex(text, soup);
    else if (keyword == "f")
      read_obj_facet(text, soup);
    else if (!keyword.empty() && keyword.front() != '#' && !is_in(kIgnored, keyword))
      refuse_keyword(keyword, text);
  }
  return soup;
}

PolygonSoup parse_shape_table(std::string_view bytes, const std::string& name) {
  MeshText text(without_byte_order_mark(bytes), name);
  std::string_view first = text.word_of_line();
  for (; !text.at_end() && (first.empty() || first.front() == '#'); first = text.word_of_line())
    text.skip_line();
  if (first != "v" && first != "f" && !is_in(kIgnored, first))
    text.fail(
        "begins with '" + shown_word(first) +
        "'; a .tab is read as a shape model of lines 'v x y z' and 'f i j k', which count from 1 (OBJ)");
  return parse_obj(bytes, name);
}

}  // namespace landfall
