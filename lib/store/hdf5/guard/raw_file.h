// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace landfall::h5 {

/// Thrown inside the checks of this folder where the bytes of a file contradict its format.
struct Damaged {};

/// HDF5's address of data that are not stored.
inline constexpr std::uint64_t kNoAddress = ~std::uint64_t{0};

/// The bytes of a file, read without HDF5.
class RawFile {
 public:
  /// A file that cannot be opened has the size 0.
  explicit RawFile(const std::filesystem::path& path);
  ~RawFile();
  RawFile(const RawFile&) = delete;
  RawFile& operator=(const RawFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] bool holds(std::uint64_t address, std::uint64_t count) const {
    return address <= size_ && count <= size_ - address;
  }
  /// Throws Damaged for bytes that are not in the file, before it allocates memory for them; FormatError,
  /// with the system's reason, if reading fails.
  [[nodiscard]] std::vector<std::byte> read(std::uint64_t address, std::uint64_t count) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

/// Takes little-endian numbers from bytes, in order. Throws Damaged at their end.
class ByteCursor {
 public:
  explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - position_; }
  [[nodiscard]] std::size_t position() const { return position_; }
  /// The next `size` bytes, at most 8, as a number.
  std::uint64_t number(std::size_t size);
  std::span<const std::byte> take(std::uint64_t count);
  void skip(std::uint64_t count) { static_cast<void>(take(count)); }
  /// Throws Damaged unless these bytes follow.
  void expect(const char* signature);

 private:
  std::span<const std::byte> bytes_;
  std::size_t position_ = 0;
};

inline void require_sound(bool condition) {
  if (!condition) throw Damaged();
}

}  // namespace landfall::h5
