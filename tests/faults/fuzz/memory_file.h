// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

namespace landfall::fuzz {

/// A file that touches no disk where the system has /dev/shm. It lives as long as this does; a process that
/// is killed leaves it behind. (HDF5 opens no file without a path of its own, as memfd_create() makes them.)
class MemoryFile {
 public:
  MemoryFile();
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Replaces the file by a new one with this content: a file that libhdf5 failed to close, because the
  /// harness damaged it while it was open, cannot be opened again.
  void fill(std::span<const std::byte> bytes);
  /// Replaces one byte.
  void put(std::size_t offset, std::byte value);

 private:
  void create();
  void remove();
  int descriptor_ = -1;
  std::filesystem::path path_;
};

}  // namespace landfall::fuzz
