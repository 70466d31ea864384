// SPDX-License-Identifier: GPL-3.0-or-later
#include "memory_file.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <system_error>

namespace landfall::fuzz {
namespace {

void require(bool done) {
  if (!done) throw std::system_error(errno, std::generic_category(), "a file in memory");
}

}  // namespace

MemoryFile::MemoryFile() : descriptor_(::memfd_create("landfall-fuzz", MFD_CLOEXEC)) {
  require(descriptor_ >= 0);
  path_ = "/proc/self/fd/" + std::to_string(descriptor_);
}

MemoryFile::~MemoryFile() { ::close(descriptor_); }

void MemoryFile::fill(std::span<const std::byte> bytes) {
  require(::ftruncate(descriptor_, 0) == 0);
  while (!bytes.empty()) {
    const ssize_t count =
        ::pwrite(descriptor_, bytes.data(), bytes.size(), ::lseek(descriptor_, 0, SEEK_END));
    require(count > 0);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

}  // namespace landfall::fuzz
