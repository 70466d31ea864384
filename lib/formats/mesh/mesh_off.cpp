// SPDX-License-Identifier: GPL-3.0-or-later
// OFF (Geomview, object file format). What follows a vertex or a facet on its line is a normal, a colour or a
// texture coordinate.
#include <algorithm>

#include "base/text/foreign_content.h"
#include "formats/mesh/mesh_file.h"
#include "formats/mesh/mesh_text.h"

namespace landfall {
namespace {

/// The first word of the next line that is neither empty nor a comment.
std::string_view word_of_next_line(MeshText& text, const char* wanted) {
  for (;;) {
    if (text.at_end()) text.fail(std::string("ends before ") + wanted);
    const std::string_view word = text.word_of_line();
    if (!word.empty() && word.front() != '#') return word;
    text.skip_line();
  }
}

/// The numbers that may follow x, y and z on a line, by the keyword ([ST][C][N]OFF): a normal (3), a colour
/// (3 or 4) and a texture coordinate (2).
std::vector<std::size_t> off_extras(MeshText& text) {
  const std::string_view keyword = word_of_next_line(text, "its keyword OFF");
  std::string_view rest = keyword;
  const auto take = [&](std::string_view part) {
    const bool has = rest.substr(0, part.size()) == part;
    if (has) rest.remove_prefix(part.size());
    return has;
  };
  const std::size_t texture = take("ST") ? 2 : 0;
  const bool colour = take("C");
  const std::size_t normal = take("N") ? 3 : 0;
  if (rest == "4OFF" || rest == "nOFF" || rest == "4nOFF")
    text.fail("is an OFF file of points in 4 or n dimensions ('" + shown_word(keyword) +
              "'); only 3 are read");
  if (rest != "OFF") text.fail("is not a supported OFF file: it begins with '" + shown_word(keyword) + "'");
  const std::size_t others = texture + normal;
  if (colour || others == 0) return {others, others + 3, others + 4};
  return {others};
}

std::int64_t off_count(MeshText& text, std::string_view word) {
  if (word == "BINARY") text.fail("is a binary OFF file; write it as text, or as PLY or STL");
  const std::int64_t count = text.integer(word);
  if (count < 0) text.fail("a count of " + std::to_string(count));
  return count;
}

void read_off_vertex(MeshText& text, const std::vector<std::size_t>& extras, PolygonSoup& soup) {
  const double x = text.number(word_of_next_line(text, "its last vertex"));
  const double y = text.number(text.word_of_line());
  soup.points.emplace_back(x, y, text.number(text.word_of_line()));
  const std::size_t extra = text.numbers_of_line().size();
  if (std::ranges::find(extras, extra) == extras.end())
    text.fail("a vertex of " + std::to_string(3 + extra) +
              " numbers, which the keyword of the file does not allow");
}

void read_off_facet(MeshText& text, PolygonSoup& soup) {
  const auto fail = [&](const std::string& what) { text.fail(what); };
  const std::int64_t corners = off_count(text, word_of_next_line(text, "its last facet"));
  for (std::int64_t k = 0; k < corners; ++k)
    soup.corners.push_back(point_number(text.integer(text.word_of_line()), fail));
  end_polygon(soup, fail);
  const std::size_t colour = text.numbers_of_line().size();
  if (colour != 0 && colour != 1 && colour != 3 && colour != 4)
    text.fail(std::to_string(colour) + " numbers after the corners of a facet; a colour has 1, 3 or 4");
}

}  // namespace

PolygonSoup parse_off(std::string_view bytes, const std::string& name) {
  PolygonSoup soup;
  MeshText text(without_byte_order_mark(bytes), name);
  const std::vector<std::size_t> extras = off_extras(text);
  const std::int64_t points = off_count(text, word_of_next_line(text, "its counts"));
  const std::int64_t facets = off_count(text, text.word_of_line());
  text.skip_line();
  for (std::int64_t i = 0; i < points; ++i, text.skip_line()) read_off_vertex(text, extras, soup);
  for (std::int64_t i = 0; i < facets; ++i, text.skip_line()) read_off_facet(text, soup);
  text.require_end();
  return soup;
}

}  // namespace landfall
