// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_reader.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "base/core/error.h"
#include "base/text/file_path.h"
#include "base/text/foreign_content.h"
#include "formats/points/cloud_formats.h"
#include "formats/points/text_head.h"

namespace landfall {
namespace {

enum class Format { las, e57, ply, pcd, qfit, ptx, text, none };

std::string_view first_line(std::string_view text) { return text.substr(0, text.find_first_of("\r\n")); }

bool is_ply(std::string_view begin) {
  return begin.starts_with("ply") && trimmed(first_line(begin)) == "ply" && begin.size() > 3;
}

/// Behind comments, a PCD begins with its version or its fields.
bool is_pcd(std::string_view begin) {
  while (begin.starts_with('#') && !begin.starts_with("# .PCD"))
    begin.remove_prefix(std::min(begin.find('\n'), begin.size() - 1) + 1);
  if (begin.starts_with("# .PCD") || begin.starts_with("FIELDS ") || begin.starts_with("COLUMNS "))
    return true;
  return begin.starts_with("VERSION ") && is_number(first_line(begin.substr(8)), false);
}

/// True for bytes that text does not have.
bool is_binary(std::string_view bytes) {
  return std::ranges::any_of(bytes, [](unsigned char c) { return c < ' ' && (c < '\t' || c > '\r'); });
}

/// The format that an extension promises.
Format promised_format(const std::filesystem::path& path) {
  constexpr std::array<std::pair<std::string_view, Format>, 12> kExtensions = {{{".csv", Format::text},
                                                                                {".txt", Format::text},
                                                                                {".xyz", Format::text},
                                                                                {".pts", Format::text},
                                                                                {".dat", Format::text},
                                                                                {".ply", Format::text},
                                                                                {".pcd", Format::text},
                                                                                {".e57", Format::text},
                                                                                {".ptx", Format::ptx},
                                                                                {".qi", Format::qfit},
                                                                                {".las", Format::las},
                                                                                {".laz", Format::las}}};
  const std::string extension = file_extension(path);
  for (const auto& [known, format] : kExtensions)
    if (extension == known) return format;
  return Format::none;
}

/// The format of a text, or of another file that is named like one. A grid, and binary content that no
/// message explains, are left to those who read rasters.
Format text_format(std::string_view begin, bool is_all, Format promised) {
  constexpr std::size_t kSignature = 8;
  if (is_grid_text(begin)) return Format::none;
  if (promised == Format::none && is_binary(begin)) return Format::none;
  if (foreign_content(begin).empty() && is_binary(begin.substr(0, kSignature))) return Format::none;
  const TextHead head = text_head(begin, is_all);
  if (is_ptx(head) || promised == Format::ptx) return Format::ptx;
  return promised == Format::text || holds_rows_of_points(head) ? Format::text : Format::none;
}

Format format_in(const CloudBytes& file, Format promised) {
  const std::vector<std::byte> bytes = beginning_of_text(file);
  const std::string_view begin = without_byte_order_mark(text_of(bytes));
  if (begin.starts_with("LASF")) return Format::las;
  if (begin.starts_with("ASTM-E57")) return Format::e57;
  if (is_ply(begin)) return Format::ply;
  if (is_pcd(begin)) return Format::pcd;
  if (is_qfit(file)) return Format::qfit;
  if (promised == Format::las || promised == Format::qfit) return promised;
  return text_format(begin, bytes.size() == file.size(), promised);
}

void require_las(const CloudBytes& file) {
  const std::vector<std::byte> bytes = file.up_to(0, 4);
  if (text_at(bytes, 0, bytes.size()) != "LASF") file.fail("is not a LAS file: it does not begin with LASF");
}

[[noreturn]] void refuse_e57(const CloudBytes& file) {
  file.fail("is an E57 file, which is not read: convert it, with pdal translate " + file.name() +
            " points.las, or CloudCompare");
}

void require_no_choice(const CloudBytes& file, const ColumnChoice& choice, const char* format) {
  if (!choice.empty())
    throw UsageError("--columns is for text, PLY and PCD; " + file.name() + " is " + format +
                     ", whose columns are fixed");
}

}  // namespace

bool is_cloud_file(const std::filesystem::path& path) {
  const Format promised = promised_format(path);
  if (!std::filesystem::is_regular_file(status_of(path))) return promised != Format::none;
  return format_in(CloudBytes(path), promised) != Format::none;
}

std::unique_ptr<CloudReader> open_cloud(const std::filesystem::path& path, const ColumnChoice& choice) {
  auto file = std::make_unique<CloudBytes>(path);
  if (file->size() == 0) file->fail("is empty");
  switch (format_in(*file, promised_format(path))) {
    case Format::las:
      require_las(*file);
      require_no_choice(*file, choice, "LAS");
      return open_las(std::move(file));
    case Format::ply:
      return open_ply_cloud(std::move(file), choice);
    case Format::pcd:
      return open_pcd(std::move(file), choice);
    case Format::ptx:
      require_no_choice(*file, choice, "PTX");
      return open_ptx(std::move(file));
    case Format::qfit:
      require_no_choice(*file, choice, "QFIT");
      return open_qfit(std::move(file));
    case Format::e57:
      refuse_e57(*file);
    default:
      return open_text_cloud(std::move(file), choice);
  }
}

}  // namespace landfall
