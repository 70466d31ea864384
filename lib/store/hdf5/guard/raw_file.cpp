// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/raw_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "base/core/error.h"

namespace landfall::h5 {

RawFile::RawFile(const std::filesystem::path& path)
    : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
  struct stat status {};
  if (descriptor_ >= 0 && ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode))
    size_ = static_cast<std::uint64_t>(status.st_size);
}

RawFile::~RawFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::vector<std::byte> RawFile::read(std::uint64_t address, std::uint64_t count) const {
  require_sound(holds(address, count));
  std::vector<std::byte> bytes(count);
  for (std::size_t done = 0; done < count;) {
    const ssize_t part =
        ::pread(descriptor_, bytes.data() + done, count - done, static_cast<off_t>(address + done));
    if (part < 0 && errno == EINTR) continue;
    if (part < 0)
      throw FormatError(path_.string() + ": cannot be read: " + std::generic_category().message(errno));
    require_sound(part > 0);
    done += static_cast<std::size_t>(part);
  }
  return bytes;
}

std::span<const std::byte> ByteCursor::take(std::uint64_t count) {
  require_sound(count <= left());
  const auto taken = bytes_.subspan(position_, count);
  position_ += count;
  return taken;
}

std::uint64_t ByteCursor::number(std::size_t size) {
  std::uint64_t value = 0;
  const std::span<const std::byte> bytes = take(size);
  for (std::size_t i = 0; i < size; ++i) value |= std::to_integer<std::uint64_t>(bytes[i]) << 8U * i;
  return value;
}

void ByteCursor::expect(const char* signature) {
  for (; *signature != '\0'; ++signature) require_sound(number(1) == static_cast<unsigned char>(*signature));
}

}  // namespace landfall::h5
