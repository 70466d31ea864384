// SPDX-License-Identifier: GPL-3.0-or-later
// The vertices of a PLY as points.
#include <algorithm>
#include <utility>

#include "base/text/joined.h"
#include "base/text/shown_text.h"
#include "formats/mesh/ply_header.h"
#include "formats/points/cloud_formats.h"
#include "formats/points/row_reader.h"
#include "formats/points/text_rows.h"

namespace landfall {
namespace {

constexpr std::int64_t kMaxRows = std::int64_t{1} << 62U;

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

[[noreturn]] void refuse_count(const CloudBytes& file, const PlyElement& element) {
  file.fail("declares " + std::to_string(element.count) + " elements " + shown_word(element.name) +
            ", more than it has: it is truncated, or its header is wrong");
}

/// Numbers of a file that are read from front to back.
class ForwardBytes {
 public:
  explicit ForwardBytes(const CloudBytes& file) : file_(file) {}
  /// No bytes where the file ends before.
  [[nodiscard]] const std::byte* at(std::uint64_t offset, std::size_t size) {
    if (offset < begin_ || offset + size > begin_ + block_.size()) {
      begin_ = offset;
      block_ = file_.up_to(offset, std::size_t{1} << 20U);
    }
    return block_.size() < size ? nullptr : block_.data() + (offset - begin_);
  }

 private:
  const CloudBytes& file_;
  std::uint64_t begin_ = 0;
  std::vector<std::byte> block_;
};

/// The end of an element with lists, whose lengths stand in its rows.
std::uint64_t end_of_lists(const CloudBytes& file, const PlyElement& element, std::uint64_t at,
                           bool is_big_endian) {
  ForwardBytes bytes(file);
  for (std::int64_t row = 0; row < element.count; ++row) {
    for (const PlyProperty& property : element.properties) {
      double count = 1;
      if (property.length) {
        const std::byte* const length = bytes.at(at, size_of(*property.length));
        count = length != nullptr ? stored_number(*property.length, length, is_big_endian) : -1;
        at += size_of(*property.length);
      }
      if (!(count >= 0) || at > file.size()) refuse_count(file, element);
      at += static_cast<std::uint64_t>(count) * size_of(property.type);
    }
    if (at > file.size()) refuse_count(file, element);
  }
  return at;
}

/// The end of the elements behind the vertices.
std::uint64_t end_of_elements(const CloudBytes& file, const PlyHeader& header, const PlyElement& vertex,
                              std::uint64_t at) {
  const bool is_big_endian = header.encoding == PlyEncoding::big_endian;
  for (const PlyElement* element = &vertex + 1; element < header.elements.data() + header.elements.size();
       ++element) {
    const bool has_lists = std::ranges::any_of(
        element->properties, [](const PlyProperty& property) { return property.length.has_value(); });
    if (has_lists) {
      at = end_of_lists(file, *element, at, is_big_endian);
      continue;
    }
    const std::uint64_t row = row_bytes(file, *element);
    if (row > 0 && static_cast<std::uint64_t>(element->count) > (file.size() - at) / row)
      refuse_count(file, *element);
    at += row * static_cast<std::uint64_t>(element->count);
  }
  return at;
}

/// Judges what lies behind the vertices of a binary file.
std::string rest_of(const CloudBytes& file, const RowLayout& rows, const PlyHeader& header,
                    const PlyElement& vertex) {
  require_rows(file, rows);
  const std::uint64_t end = end_of_elements(file, header, vertex, rows.begin + rows.count * rows.row_size);
  return judge_rest(file, rows, file.size() - end);
}

/// A text has one line for each row of each element.
void require_lines(const CloudBytes& file, const PlyHeader& header) {
  std::int64_t declared = 0;
  for (const PlyElement& element : header.elements) declared += std::min(element.count, kMaxRows - declared);
  std::int64_t lines = 0;
  bool is_blank_so_far = true;
  for (std::uint64_t at = header.end; at < file.size();) {
    const std::vector<std::byte> bytes = file.up_to(at, std::size_t{1} << 20U);
    for (const char c : text_of(bytes)) {
      if (c == '\n' || c == '\r')
        is_blank_so_far = true;
      else if (is_blank_so_far && !is_blank(c)) {
        is_blank_so_far = false;
        ++lines;
      }
    }
    at += bytes.size();
  }
  if (lines != declared)
    file.fail("declares " + std::to_string(declared) + " rows of vertices and other elements, but has " +
              std::to_string(lines) + ": it is truncated, or its header is wrong");
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
  const std::vector<std::byte> bytes = beginning_of(*file, [](std::string_view text) {
    const std::size_t end = text.find("end_header");
    return end != std::string_view::npos && text.find_first_of("\r\n", end) != std::string_view::npos;
  });
  const std::string_view text = text_of(bytes);
  const PlyHeader header = read_ply_header(text, file->name());
  const PlyElement& vertex = vertex_of(*file, header);
  std::vector<std::string> names;
  for (const PlyProperty& property : vertex.properties) names.push_back(property.name);
  CloudInfo info = info_of("PLY", cloud_columns(names, choice, file->name()));
  info.is_float32 = float32_axes(info.columns, [&](std::size_t i) { return vertex.properties[i].type; });
  if (const std::string ignored = ignored_elements(header); !ignored.empty())
    info.notes.push_back("its elements other than the vertices are ignored: " + ignored);
  RowLayout rows{.begin = header.end,
                 .row_size = static_cast<std::size_t>(row_bytes(*file, vertex)),
                 .count = static_cast<std::uint64_t>(vertex.count),
                 .is_big_endian = header.encoding == PlyEncoding::big_endian,
                 .columns = {}};
  if (header.encoding == PlyEncoding::text) {
    if (has_elements_behind(header, vertex)) require_lines(*file, header);
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
  info.notes.push_back(rest_of(*file, rows, header, vertex));
  std::erase(info.notes, "");
  return read_rows(std::move(file), std::move(rows), std::move(info));
}

}  // namespace landfall
