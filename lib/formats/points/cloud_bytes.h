// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace landfall {

/// A file whose bytes are read at any offset; none is read beyond its end.
class CloudBytes {
 public:
  /// Throws FormatError unless `path` is a regular file that can be read.
  explicit CloudBytes(const std::filesystem::path& path);
  ~CloudBytes();
  CloudBytes(const CloudBytes&) = delete;
  CloudBytes& operator=(const CloudBytes&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  /// Fills `out` with the bytes at `offset`. Throws FormatError where the file ends before, or reading fails.
  void read(std::uint64_t offset, std::span<std::byte> out) const;
  /// At most `count` bytes at `offset`: fewer where the file ends.
  [[nodiscard]] std::vector<std::byte> up_to(std::uint64_t offset, std::size_t count) const;
  /// Throws FormatError "NAME: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string name_;
  int descriptor_;
  std::uint64_t size_;
};

[[nodiscard]] inline std::string_view text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The first bytes of a file: 256 KiB, or twice as many again and again, up to 64 MiB, until they hold a
/// whole header: comments have any length.
template <class HoldsHeader>
[[nodiscard]] std::vector<std::byte> beginning_of(const CloudBytes& file, const HoldsHeader& holds_header) {
  constexpr std::size_t kMax = std::size_t{1} << 26U;
  for (std::size_t size = std::size_t{1} << 18U;; size *= 2) {
    std::vector<std::byte> bytes = file.up_to(0, size);
    if (size >= kMax || bytes.size() == file.size() || holds_header(text_of(bytes))) return bytes;
  }
}

/// The little-endian number at an offset, which must lie within the bytes.
template <class T>
[[nodiscard]] T number_at(std::span<const std::byte> bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.subspan(offset, sizeof(T)).data(), sizeof(T));
  return value;
}

/// Text of a fixed length, up to its first zero.
[[nodiscard]] std::string text_at(std::span<const std::byte> bytes, std::size_t offset, std::size_t length);

}  // namespace landfall
