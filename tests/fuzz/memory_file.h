// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace landfall::fuzz {

/// A file that has a path and touches no disk. It lives as long as this does.
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  /// What every program of this process may open.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Replaces the content.
  void fill(std::span<const std::byte> bytes);

 private:
  int descriptor_;
  std::filesystem::path path_;
};

}  // namespace landfall::fuzz
