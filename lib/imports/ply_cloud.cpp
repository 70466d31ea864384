// SPDX-License-Identifier: GPL-3.0-or-later
// The vertices of a PLY as points.
#include <algorithm>
#include <utility>

#include "base/joined.h"
#include "base/shown_text.h"
#include "imports/cloud_formats.h"
#include "imports/row_reader.h"
#include "imports/text_rows.h"
#include "meshio/ply_header.h"

namespace landfall {
namespace {

constexpr std::size_t kMaxPlyHeader = 1U << 18U;

std::uint64_t row_bytes(const CloudBytes& file, const PlyElement& element) {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    if (property.length)
      file.fail("its element " + shown_word(element.name) + " has a list: only numbers are read");
    bytes += size_of(property.type);
  }
  return bytes;
}

/// The elements before the vertices: rows of known size, or lines.
std::uint64_t skipped_rows(const CloudBytes& file, const PlyHeader& header, const PlyElement& vertex,
                           bool as_lines) {
  std::uint64_t skipped = 0;
  for (const PlyElement& element : header.elements) {
    if (&element == &vertex) break;
    const std::uint64_t size = as_lines ? 1 : row_bytes(file, element);
    const auto count = static_cast<std::uint64_t>(element.count);
    if (size > 0 && count > (file.size() - std::min(skipped, file.size())) / size)
      file.fail("is shorter than its elements before the vertices");
    skipped += size * count;
  }
  return skipped;
}

std::uint64_t after_lines(const CloudBytes& file, std::uint64_t at, std::uint64_t lines) {
  while (lines > 0) {
    const std::vector<std::byte> bytes = file.up_to(at, 1U << 16U);
    if (bytes.empty()) file.fail("ends before its vertices");
    for (const std::byte byte : bytes) {
      ++at;
      if (byte == std::byte{'\n'} && --lines == 0) break;
    }
  }
  return at;
}

/// The bytes of the elements behind the vertices; with lists, whose lengths stand in the rows, the least
/// ones.
struct Following {
  std::uint64_t bytes = 0;
  bool is_exact = true;
};

Following elements_behind(const CloudBytes& file, const PlyHeader& header, const PlyElement& vertex) {
  Following following;
  for (const PlyElement* element = &vertex + 1; element < header.elements.data() + header.elements.size();
       ++element) {
    std::uint64_t row = 0;
    for (const PlyProperty& property : element->properties) {
      row += size_of(property.length.value_or(property.type));
      if (property.length && element->count > 0) following.is_exact = false;
    }
    const auto count = static_cast<std::uint64_t>(element->count);
    if (row > 0 && count > file.size() / row)
      file.fail("declares " + std::to_string(count) + " elements " + shown_word(element->name) +
                ", more than it has: it is truncated, or its header is wrong");
    following.bytes += row * count;
  }
  return following;
}

/// Judges what lies behind the vertices of a binary file.
std::string rest_of(const CloudBytes& file, const RowLayout& rows, const Following& following) {
  require_rows(file, rows);
  const std::uint64_t behind = file.size() - rows.begin - rows.count * rows.row_size;
  if (following.bytes > behind)
    file.fail("declares elements behind its vertices of at least " + std::to_string(following.bytes) +
              " bytes, but has " + std::to_string(behind) + ": it is truncated, or its header is wrong");
  return following.is_exact ? judge_rest(file, rows, behind - following.bytes) : "";
}

const PlyElement& vertex_of(const CloudBytes& file, const PlyHeader& header) {
  const auto found = std::ranges::find(header.elements, "vertex", &PlyElement::name);
  if (found == header.elements.end()) file.fail("has no element vertex");
  return *found;
}

bool has_elements_behind(const PlyHeader& header, const PlyElement& vertex) {
  return std::any_of(&vertex + 1, header.elements.data() + header.elements.size(),
                     [](const PlyElement& element) { return element.count > 0; });
}

std::string ignored_elements(const PlyHeader& header) {
  return joined(header.elements, ", ", [](const PlyElement& element) {
    const bool is_ignored = element.name != "vertex" && element.count > 0;
    return is_ignored ? std::to_string(element.count) + " " + shown_word(element.name) : "";
  });
}

}  // namespace

std::unique_ptr<CloudReader> open_ply_cloud(std::unique_ptr<CloudBytes> file, const ColumnChoice& choice) {
  const std::vector<std::byte> bytes = file->up_to(0, kMaxPlyHeader);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const PlyHeader header = read_ply_header(text, file->name());
  const PlyElement& vertex = vertex_of(*file, header);
  std::vector<std::string> names;
  for (const PlyProperty& property : vertex.properties) names.push_back(property.name);
  CloudInfo info = info_of("PLY", cloud_columns(names, choice, file->name()));
  info.is_float32 = float32_axes(info.columns, [&](std::size_t i) { return vertex.properties[i].type; });
  if (const std::string ignored = ignored_elements(header); !ignored.empty())
    info.notes.push_back("its elements beside the vertices are ignored: " + ignored);
  RowLayout rows{.begin = header.end,
                 .row_size = static_cast<std::size_t>(row_bytes(*file, vertex)),
                 .count = static_cast<std::uint64_t>(vertex.count),
                 .is_big_endian = header.encoding == PlyEncoding::big_endian,
                 .columns = {}};
  if (header.encoding == PlyEncoding::text) {
    const std::uint64_t lines = skipped_rows(*file, header, vertex, true);
    const auto before = static_cast<std::size_t>(std::ranges::count(text.substr(0, header.end), '\n'));
    const TextRows in_text{.begin = after_lines(*file, header.end, lines),
                           .first_line = before + lines + 1,
                           .count = vertex.count,
                           .may_continue = has_elements_behind(header, vertex),
                           .column_count = names.size()};
    return std::make_unique<TextReader>(std::move(file), in_text, std::move(info));
  }
  rows.begin += skipped_rows(*file, header, vertex, false);
  std::size_t offset = 0;
  for (const PlyProperty& property : vertex.properties) {
    rows.columns.push_back({property.name, property.type, offset});
    offset += size_of(property.type);
  }
  info.notes.push_back(rest_of(*file, rows, elements_behind(*file, header, vertex)));
  std::erase(info.notes, "");
  return read_rows(std::move(file), std::move(rows), std::move(info));
}

}  // namespace landfall
