// SPDX-License-Identifier: GPL-3.0-or-later
// LibLZF: a control byte c < 32 is followed by c + 1 literal bytes; otherwise c >> 5 (7: plus the next byte)
// + 2 bytes are copied from (c & 31) << 8 + next byte + 1 bytes before.
#include "formats/points/lzf.h"

#include <algorithm>

namespace landfall {

LzfStream::LzfStream(const CloudBytes& file, std::uint64_t begin, std::uint64_t size)
    : file_(&file), at_(begin), end_(begin + size) {}

unsigned LzfStream::next_byte() {
  if (used_ == input_.size()) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(kInput, end_ - at_));
    if (count == 0) file_->fail("its compressed points end too early");
    input_ = file_->up_to(at_, count);
    if (input_.empty()) file_->fail("its compressed points end too early");
    at_ += input_.size();
    used_ = 0;
  }
  return std::to_integer<unsigned>(input_[used_++]);
}

void LzfStream::begin_run() {
  const unsigned control = next_byte();
  if (control < 32) {
    run_ = control + 1;
    back_ = 0;
    return;
  }
  run_ = control >> 5U;
  if (run_ == 7) run_ += next_byte();
  run_ += 2;
  back_ = ((control & 31U) << 8U) + next_byte() + 1;
  if (back_ > decoded_) file_->fail("its compressed points refer to bytes before their beginning");
}

std::byte LzfStream::next_decoded() {
  if (run_ == 0) begin_run();
  --run_;
  const std::byte value =
      back_ == 0 ? static_cast<std::byte>(next_byte()) : history_[(decoded_ - back_) % kHistory];
  history_[decoded_++ % kHistory] = value;
  return value;
}

void LzfStream::read(std::span<std::byte> out) {
  for (std::byte& value : out) value = next_decoded();
}

void LzfStream::skip(std::uint64_t count) {
  for (; count > 0; --count) static_cast<void>(next_decoded());
}

}  // namespace landfall
