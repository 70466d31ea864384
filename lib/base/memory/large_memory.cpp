// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory/large_memory.h"

#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <vector>

namespace landfall {
namespace {

constexpr std::size_t kMaxKept = std::size_t{128} << 20U;

std::size_t whole_pages(std::size_t byte_count) {
  return (byte_count + kHugePage - 1) / kHugePage * kHugePage;
}

void* map_block(std::size_t byte_count) {
  const std::size_t mapped = byte_count + kHugePage;
  if (mapped < byte_count) throw std::bad_alloc();
  void* const memory = mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  const std::size_t before = (kHugePage - reinterpret_cast<std::uintptr_t>(memory) % kHugePage) % kHugePage;
  char* const block = static_cast<char*>(memory) + before;
  if (before > 0) munmap(memory, before);
  munmap(block + byte_count, kHugePage - before);
  madvise(block, byte_count, MADV_HUGEPAGE);  // only a hint: small pages work as well
  return block;
}

/// Released blocks that are kept for reuse.
class Shelf {
 public:
  /// Returns null if no block of this size is kept.
  void* take(std::size_t byte_count) {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(blocks_, byte_count, &Block::byte_count);
    if (found == blocks_.end()) return nullptr;
    void* const memory = found->memory;
    blocks_.erase(found);
    kept_ -= byte_count;
    return memory;
  }

  /// Returns false if there is no room.
  bool keep(void* memory, std::size_t byte_count) noexcept {
    const std::lock_guard lock(mutex_);
    if (byte_count > kMaxKept - kept_) return false;
    blocks_.push_back({memory, byte_count});  // within the reserved capacity
    kept_ += byte_count;
    return true;
  }

 private:
  struct Block {
    void* memory;
    std::size_t byte_count;
  };

  static std::vector<Block> room_for_all() {
    std::vector<Block> blocks;
    blocks.reserve(kMaxKept / kHugePage);
    return blocks;
  }

  std::mutex mutex_;
  std::vector<Block> blocks_ = room_for_all();
  std::size_t kept_ = 0;
};

/// Never destroyed, because other static objects may return blocks while they are destroyed.
Shelf& shelf() {
  static Shelf& the_shelf = *new Shelf;
  return the_shelf;
}

}  // namespace

void* take_large_block(std::size_t byte_count) {
  const std::size_t whole = whole_pages(byte_count);
  if (whole < byte_count) throw std::bad_alloc();
  void* const kept = shelf().take(whole);
  return kept != nullptr ? kept : map_block(whole);
}

void give_large_block_back(void* block, std::size_t byte_count) noexcept {
  const std::size_t whole = whole_pages(byte_count);
  if (!shelf().keep(block, whole)) munmap(block, whole);
}

}  // namespace landfall
