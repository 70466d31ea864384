// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/core/error.h"
#include "base/text/file_path.h"

namespace landfall {

CloudBytes::CloudBytes(const std::filesystem::path& path) : name_(path.string()), descriptor_(-1), size_(0) {
  require_regular_file(path);
  descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail(std::string("cannot be read: ") + std::strerror(errno));
  struct stat status {};
  if (::fstat(descriptor_, &status) != 0) fail(std::string("cannot be read: ") + std::strerror(errno));
  size_ = static_cast<std::uint64_t>(status.st_size);
}

CloudBytes::~CloudBytes() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void CloudBytes::read(std::uint64_t offset, std::span<std::byte> out) const {
  if (offset > size_ || out.size() > size_ - offset) fail("ends too early");
  while (!out.empty()) {
    const ssize_t count = ::pread(descriptor_, out.data(), out.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(std::string("reading failed: ") + std::strerror(errno));
    if (count == 0) fail("ends too early");
    out = out.subspan(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

std::vector<std::byte> CloudBytes::up_to(std::uint64_t offset, std::size_t count) const {
  const std::uint64_t left = offset < size_ ? size_ - offset : 0;
  std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::uint64_t>(left, count)));
  read(std::min(offset, size_), bytes);
  return bytes;
}

void CloudBytes::fail(const std::string& what) const { throw FormatError(name_ + ": " + what); }

std::string text_at(std::span<const std::byte> bytes, std::size_t offset, std::size_t length) {
  const std::span<const std::byte> field = bytes.subspan(offset, length);
  const auto* const begin = reinterpret_cast<const char*>(field.data());
  return {begin, std::find(begin, begin + length, '\0')};
}

}  // namespace landfall
