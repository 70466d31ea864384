// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/points/cloud_bytes.h"

namespace landfall {

/// Decodes a stream of LibLZF piece by piece from a file, with 16 KiB of history. A copy continues
/// independently from the same place.
class LzfStream {
 public:
  /// The compressed bytes [begin, begin + size) of the file, which must outlive the stream.
  LzfStream(const CloudBytes& file, std::uint64_t begin, std::uint64_t size);

  /// Decodes the next out.size() bytes. Throws FormatError if the compressed bytes end before, or refer to a
  /// place before the first byte.
  void read(std::span<std::byte> out);
  /// Decodes and drops bytes.
  void skip(std::uint64_t count);

 private:
  static constexpr std::size_t kHistory = 1U << 14U;  // a reference goes back 8 KiB at most
  static constexpr std::size_t kInput = 1U << 16U;

  [[nodiscard]] unsigned next_byte();
  void begin_run();
  [[nodiscard]] std::byte next_decoded();

  const CloudBytes* file_;
  std::uint64_t at_;  ///< in the file, of the first byte after input_
  std::uint64_t end_;
  std::vector<std::byte> input_;
  std::size_t used_ = 0;
  std::array<std::byte, kHistory> history_{};
  std::uint64_t decoded_ = 0;
  std::size_t run_ = 0;   ///< bytes that remain of the current run
  std::size_t back_ = 0;  ///< distance of a reference; 0: literal bytes
};

}  // namespace landfall
