// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/object_header.h"

#include <algorithm>
#include <utility>

namespace landfall::h5 {
namespace {

constexpr std::size_t kMaxBlocks = 4096;
constexpr std::uint64_t kMaxBlockBytes = std::uint64_t{64} << 20U;

struct Block {
  std::uint64_t address;
  std::uint64_t size;
};

class HeaderReader {
 public:
  explicit HeaderReader(const RawFile& file) : file_(file) {}

  std::vector<HeaderMessage> read(std::uint64_t address) {
    const std::vector<std::byte> start = file_.read(address, 6);
    if (start[0] == std::byte{'O'})
      read_version_2(address);
    else
      read_version_1(address);
    return std::move(messages_);
  }

 private:
  void read_version_1(std::uint64_t address) {
    constexpr std::uint64_t kPrefix = 16;
    const std::vector<std::byte> prefix = file_.read(address, kPrefix);
    ByteCursor cursor(prefix);
    require_sound(cursor.number(1) == 1);
    cursor.skip(1);
    const std::uint64_t count = cursor.number(2);
    cursor.skip(4);
    blocks_.push_back({address + kPrefix, cursor.number(4)});
    std::uint64_t found = 0;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const std::vector<std::byte> bytes = read_block(blocks_[i]);
      ByteCursor block(bytes);
      while (block.left() >= 8) {
        const auto type = static_cast<MessageType>(block.number(2));
        const std::uint64_t size = block.number(2);
        const std::uint64_t flags = block.number(1);
        block.skip(3);
        add(type, flags, block.take(size));
        require_sound(++found <= count);
      }
      require_sound(block.left() == 0);
    }
    require_sound(found == count);
  }

  void read_version_2(std::uint64_t address) {
    const std::vector<std::byte> prefix =
        file_.read(address, std::min<std::uint64_t>(34, file_.size() - address));
    ByteCursor cursor(prefix);
    cursor.expect("OHDR");
    require_sound(cursor.number(1) == 2);
    const std::uint64_t flags = cursor.number(1);
    if ((flags & 0x20U) != 0) cursor.skip(16);
    if ((flags & 0x10U) != 0) cursor.skip(4);
    const std::uint64_t size = cursor.number(std::size_t{1} << (flags & 3U));
    blocks_.push_back({address + cursor.position(), size});
    const std::size_t head = (flags & 4U) != 0 ? 6 : 4;
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const std::vector<std::byte> bytes = read_block(blocks_[i]);
      ByteCursor block(bytes);
      if (i > 0) block.expect("OCHK");
      const std::size_t checksum = i > 0 ? 4 : 0;
      while (block.left() >= head + checksum) {
        const auto type = static_cast<MessageType>(block.number(1));
        const std::uint64_t body = block.number(2);
        const std::uint64_t message_flags = block.number(1);
        block.skip(head - 4);
        add(type, message_flags, block.take(body));
      }
    }
  }

  [[nodiscard]] std::vector<std::byte> read_block(const Block& block) const {
    require_sound(block.size <= kMaxBlockBytes && blocks_.size() <= kMaxBlocks);
    return file_.read(block.address, block.size);
  }

  void add(MessageType type, std::uint64_t flags, std::span<const std::byte> body) {
    if (type == MessageType::continuation) {
      ByteCursor cursor(body);
      const std::uint64_t address = cursor.number(8);
      blocks_.push_back({address, cursor.number(8)});
      return;
    }
    messages_.push_back({type, (flags & 2U) != 0, {body.begin(), body.end()}});
  }

  const RawFile& file_;
  std::vector<Block> blocks_;
  std::vector<HeaderMessage> messages_;
};

}  // namespace

std::vector<HeaderMessage> messages_at(const RawFile& file, std::uint64_t address) {
  return HeaderReader(file).read(address);
}

}  // namespace landfall::h5
