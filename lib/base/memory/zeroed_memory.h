// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>

namespace landfall {

/// Zeroed memory. A large block costs nothing until it is touched, in huge pages where the system has them.
/// With small pages, first reading and then writing each page causes two page faults and, with several
/// threads, an interrupt on every core. Throws std::bad_alloc.
class ZeroedMemory {
 public:
  explicit ZeroedMemory(std::size_t byte_count);

  [[nodiscard]] void* data() const { return data_; }

 private:
  struct Release {
    std::size_t mapped;  ///< 0: from the heap
    void operator()(void* memory) const;
  };
  std::unique_ptr<void, Release> memory_;
  void* data_;
};

/// An array in ZeroedMemory, of a type for which all-zero bytes are a valid value.
template <class T>
class ZeroedArray {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  explicit ZeroedArray(std::size_t size) : memory_(size * sizeof(T)), size_(size) {}

  [[nodiscard]] std::span<T> values() { return {static_cast<T*>(memory_.data()), size_}; }
  [[nodiscard]] std::span<const T> values() const { return {static_cast<const T*>(memory_.data()), size_}; }
  [[nodiscard]] T& operator[](std::size_t i) { return static_cast<T*>(memory_.data())[i]; }

 private:
  ZeroedMemory memory_;
  std::size_t size_;
};

}  // namespace landfall
