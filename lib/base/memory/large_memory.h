// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>

namespace landfall {

/// From this size on, blocks use huge pages and are kept for reuse when they are given back.
inline constexpr std::size_t kLargeBlock = std::size_t{1} << 20U;

/// A huge page of x86-64, and of arm64 with pages of 4 KiB.
inline constexpr std::size_t kHugePage = std::size_t{1} << 21U;

/// Uninitialised memory, aligned to a huge page. The system clears and maps a new page on its first use,
/// which costs more than one pass over a map; a reused block avoids that cost. At most 128 MiB are kept. May
/// be called from any thread. Throws std::bad_alloc.
[[nodiscard]] void* take_large_block(std::size_t byte_count);
/// The block must have been taken with the same count.
void give_large_block_back(void* block, std::size_t byte_count) noexcept;

/// For containers of large arrays: elements made without a value are not initialised.
template <class T>
class LargeAllocator {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  using value_type = T;

  LargeAllocator() = default;
  template <class U>
  explicit LargeAllocator(const LargeAllocator<U>& /*other*/) {}

  [[nodiscard]] T* allocate(std::size_t count) {
    if (count > static_cast<std::size_t>(-1) / sizeof(T)) throw std::bad_array_new_length();
    const std::size_t byte_count = count * sizeof(T);
    return static_cast<T*>(byte_count < kLargeBlock ? ::operator new(byte_count)
                                                    : take_large_block(byte_count));
  }
  void deallocate(T* memory, std::size_t count) noexcept {
    if (count * sizeof(T) < kLargeBlock)
      ::operator delete(memory);
    else
      give_large_block_back(memory, count * sizeof(T));
  }
  void construct(T* address) { ::new (static_cast<void*>(address)) T; }
  void construct(T* address, const T& value) { ::new (static_cast<void*>(address)) T(value); }

  friend bool operator==(const LargeAllocator& /*a*/, const LargeAllocator& /*b*/) { return true; }
};

}  // namespace landfall
