// SPDX-License-Identifier: GPL-3.0-or-later
#include "imports/cloud_reader.h"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "base/error.h"
#include "base/file_path.h"
#include "imports/cloud_formats.h"

namespace landfall {
namespace {

constexpr std::size_t kMagic = 16;

std::string beginning(const CloudBytes& file) {
  const std::vector<std::byte> bytes = file.up_to(0, kMagic);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

bool is_las(std::string_view begin) { return begin.starts_with("LASF"); }
bool is_e57(std::string_view begin) { return begin.starts_with("ASTM-E57"); }
bool is_ply(std::string_view begin) { return begin.starts_with("ply\n") || begin.starts_with("ply\r"); }
bool is_pcd(std::string_view begin) {
  return begin.starts_with("# .PCD") || begin.starts_with("VERSION") || begin.starts_with("FIELDS");
}

[[noreturn]] void refuse_e57(const CloudBytes& file) {
  file.fail("is an E57 file, which is not read: convert it, with pdal translate " + file.name() +
            " points.las, or CloudCompare");
}

}  // namespace

bool is_cloud_file(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 10> kExtensions = {".csv", ".txt", ".xyz", ".pts", ".dat",
                                                            ".las", ".laz", ".ply", ".pcd", ".e57"};
  if (std::ranges::find(kExtensions, file_extension(path)) != kExtensions.end()) return true;
  std::error_code unreachable;
  if (!std::filesystem::is_regular_file(path, unreachable)) return false;
  const std::string begin = beginning(CloudBytes(path));
  return is_las(begin) || is_ply(begin) || is_e57(begin) || begin.starts_with("# .PCD");
}

std::unique_ptr<CloudReader> open_cloud(const std::filesystem::path& path, const ColumnChoice& choice) {
  auto file = std::make_unique<CloudBytes>(path);
  const std::string begin = beginning(*file);
  if (begin.empty()) file->fail("is empty");
  if (is_las(begin) && !choice.empty())
    throw UsageError("--columns is for text, PLY and PCD; " + path.string() +
                     " is LAS, whose columns are fixed");
  if (is_las(begin)) return open_las(std::move(file));
  if (is_ply(begin)) return open_ply_cloud(std::move(file), choice);
  if (is_pcd(begin)) return open_pcd(std::move(file), choice);
  if (is_e57(begin)) refuse_e57(*file);
  if (const std::string extension = file_extension(path); extension == ".las" || extension == ".laz")
    file->fail("is not a LAS file: it does not begin with LASF");
  return open_text_cloud(std::move(file), choice);
}

}  // namespace landfall
