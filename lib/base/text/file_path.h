// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <string>
#include <system_error>

#include "base/core/error.h"

namespace landfall {

/// The extension of a file name with its dot, A to Z in lower case: ".tif" for "a.b/Site.TIF"; empty if the
/// name has none.
inline std::string file_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

/// The status of what a path leads to, links followed; of no type where it cannot be reached.
inline std::filesystem::file_status status_of(const std::filesystem::path& path) {
  std::error_code unreachable;
  return std::filesystem::status(path, unreachable);
}

/// Throws FormatError unless `path` leads to a regular file that may be read: opening a pipe or a device
/// would block.
inline void require_regular_file(const std::filesystem::path& path) {
  const std::filesystem::file_status status = status_of(path);
  if (!std::filesystem::exists(status)) throw FormatError(path.string() + ": no such file");
  if (std::filesystem::is_directory(status)) throw FormatError(path.string() + ": is a directory");
  if (!std::filesystem::is_regular_file(status)) throw FormatError(path.string() + ": is not a regular file");
  if (::access(path.c_str(), R_OK) != 0)
    throw FormatError(path.string() + ": cannot be read: " + std::generic_category().message(errno));
}

}  // namespace landfall
