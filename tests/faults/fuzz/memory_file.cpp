// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <string>
#include <system_error>

namespace landfall::fuzz {
namespace {

void require(bool done) {
  if (!done) throw std::system_error(errno, std::generic_category(), "a file in memory");
}

}  // namespace

MemoryFile::MemoryFile() { create(); }

MemoryFile::~MemoryFile() { remove(); }

void MemoryFile::create() {
  const std::filesystem::path in_memory = "/dev/shm";
  const bool has_memory = std::filesystem::is_directory(in_memory);
  std::string name =
      ((has_memory ? in_memory : std::filesystem::temp_directory_path()) / "landfall-fuzz-XXXXXX").string();
  descriptor_ = ::mkstemp(name.data());
  require(descriptor_ >= 0);
  path_ = name;
}

void MemoryFile::remove() {
  ::close(descriptor_);
  ::unlink(path_.c_str());
}

void MemoryFile::fill(std::span<const std::byte> bytes) {
  remove();
  create();
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), ::lseek(descriptor_, 0, SEEK_END));
    require(count > 0);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

void MemoryFile::put(std::size_t offset, std::byte value) {
  require(::pwrite(descriptor_, &value, 1, static_cast<off_t>(offset)) == 1);
}

}  // namespace landfall::fuzz
