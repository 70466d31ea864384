// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "base/core/error.h"

/// The fuzz target: the name by which both libFuzzer and standalone_main.cpp call it. Returns 0.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace landfall::fuzz {

/// A promise that an input has broken, other than by an exception of another kind.
class BrokenPromise : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Messages are to be read: longer ones repeat an input instead of naming what is wrong with it.
inline constexpr std::size_t kLongestMessage = 2000;

/// True where `use` ran to its end, false where it refused its input by one of landfall's own errors. Any
/// other exception passes through, which is a finding; so is, as BrokenPromise, a refusal whose message is
/// empty, longer than kLongestMessage, or does not hold `culprit`: the file or option that it is about.
template <class Use>
bool accepts(std::string_view culprit, const Use& use) {
  try {
    use();
    return true;
  } catch (const Error& error) {
    const std::string message = error.what();
    if (message.empty() || message.size() > kLongestMessage || message.find(culprit) == std::string::npos)
      throw BrokenPromise("a refusal of " + std::to_string(message.size()) + " bytes, to name '" +
                          std::string(culprit) + "': " + message.substr(0, kLongestMessage));
    return false;
  }
}

/// The bytes of an input, taken one after the other; zeros once they have run out.
class InputBytes {
 public:
  explicit InputBytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }

  /// Below `count`, which is at most 65536; 0 where that is 0.
  std::size_t below(std::size_t count) {
    std::size_t value = byte();
    if (count > 256) value = 256 * value + byte();
    return count == 0 ? 0 : value % count;
  }

  /// The bytes up to the next one that is `end`, which is passed over, or all that are left.
  std::string until(std::uint8_t end) {
    std::string text;
    while (!bytes_.empty()) {
      const std::uint8_t next = byte();
      if (next == end) break;
      text.push_back(static_cast<char>(next));
    }
    return text;
  }

  std::string rest() {
    std::string text(bytes_.begin(), bytes_.end());
    bytes_ = {};
    return text;
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

}  // namespace landfall::fuzz
