// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "base/error.h"

namespace landfall {

/// Throws FormatError unless `path` leads to a regular file that may be read: opening a pipe or a device
/// would block.
inline void require_regular_file(const std::filesystem::path& path) {
  std::error_code unreachable;
  const std::filesystem::file_status status = std::filesystem::status(path, unreachable);
  if (!std::filesystem::exists(status)) throw FormatError(path.string() + ": no such file");
  if (std::filesystem::is_directory(status)) throw FormatError(path.string() + ": is a directory");
  if (!std::filesystem::is_regular_file(status)) throw FormatError(path.string() + ": is not a regular file");
  if (::access(path.c_str(), R_OK) != 0)
    throw FormatError(path.string() + ": cannot be read: " + std::generic_category().message(errno));
}

}  // namespace landfall
