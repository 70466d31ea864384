// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory/zeroed_memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <new>

#include "base/memory/large_memory.h"

namespace landfall {
namespace {

void* next_huge_page(void* address) {
  const auto number = reinterpret_cast<std::uintptr_t>(address);
  return static_cast<char*>(address) + (kHugePage - number % kHugePage) % kHugePage;
}

}  // namespace

void ZeroedMemory::Unmap::operator()(void* memory) const { munmap(memory, byte_count); }

ZeroedMemory::ZeroedMemory(std::size_t byte_count) {
  const std::size_t mapped = byte_count + kHugePage;
  if (mapped < byte_count) throw std::bad_alloc();
  void* const memory = mmap(nullptr, mapped, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  memory_ = {memory, Unmap{mapped}};
  data_ = next_huge_page(memory);
  madvise(data_, byte_count, MADV_HUGEPAGE);  // only a hint: small pages work as well
}

}  // namespace landfall
