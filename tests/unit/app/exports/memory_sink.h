// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstring>
#include <string>

#include "base/output/byte_sink.h"

namespace landfall {

/// Stores the written bytes in memory.
class MemorySink final : public ByteSink {
 public:
  void write(std::string_view bytes) override { bytes_ += bytes; }
  void finish() override {}
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// The little-endian number at `offset`.
template <class T>
[[nodiscard]] T at(const std::string& bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

}  // namespace landfall
