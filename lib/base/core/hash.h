// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace landfall {

/// A 128-bit XXH3 digest, computed piece by piece. It identifies files and configurations. It is not
/// cryptographic: colliding inputs can be constructed.
class Hash {
 public:
  Hash();
  ~Hash();
  Hash(const Hash&) = delete;
  Hash& operator=(const Hash&) = delete;

  Hash& update(std::span<const std::byte> bytes);
  /// Adds the text and its length, so that ("ab", "c") and ("a", "bc") differ.
  Hash& update(std::string_view text);
  /// The high and the low 64 bits.
  [[nodiscard]] std::array<std::uint64_t, 2> words() const;
  /// 32 lower-case hexadecimal digits.
  [[nodiscard]] std::string hex() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace landfall
