// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory/zeroed_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <new>

#include "base/memory/large_memory.h"

namespace landfall {
namespace {

constexpr std::size_t kCacheLine = 64;

void* next_huge_page(void* address) {
  const auto number = reinterpret_cast<std::uintptr_t>(address);
  return static_cast<char*>(address) + (kHugePage - number % kHugePage) % kHugePage;
}

}  // namespace

void ZeroedMemory::Release::operator()(void* memory) const {
  if (mapped == 0)
    std::free(memory);
  else
    munmap(memory, mapped);
}

ZeroedMemory::ZeroedMemory(std::size_t byte_count) {
  if (byte_count < kLargeBlock) {
    const std::size_t lines = byte_count / kCacheLine + 1;
    memory_ = {std::aligned_alloc(kCacheLine, lines * kCacheLine), Release{0}};
    if (!memory_) throw std::bad_alloc();
    data_ = std::memset(memory_.get(), 0, byte_count);
    return;
  }
  const std::size_t mapped = byte_count + kHugePage;
  if (mapped < byte_count) throw std::bad_alloc();
  void* const memory = mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  memory_ = {memory, Release{mapped}};
  data_ = next_huge_page(memory);
  madvise(data_, byte_count, MADV_HUGEPAGE);  // only a hint: small pages work as well
}

}  // namespace landfall
