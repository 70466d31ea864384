// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/igzip.h"

#include <isa-l/igzip_lib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace landfall {
namespace {

constexpr std::size_t kLongestStored = 65535;
constexpr std::size_t kStoredHeaderBytes = 5;
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30U;  // ISA-L counts in 32 bits
constexpr std::size_t kLongestSample = 65536;
constexpr std::size_t kEndBytes = 64;  // the empty block and the bits of a flush

/// ISA-L reads what it is given through pointers that are not const.
std::uint8_t* bytes_of(std::span<const std::byte> bytes) {
  return const_cast<std::uint8_t*>(reinterpret_cast<const std::uint8_t*>(bytes.data()));
}

std::uint32_t short_size(std::size_t size) { return static_cast<std::uint32_t>(size); }

}  // namespace

struct Igzip::State {
  isal_zstream stream{};
  std::vector<std::uint8_t> level_room = std::vector<std::uint8_t>(ISAL_DEF_LVL1_DEFAULT);
  std::array<std::uint8_t, kLongestSample> trial{};

  void use_level_1() {
    stream.level = 1;
    stream.level_buf = level_room.data();
    stream.level_buf_size = short_size(level_room.size());
    stream.gzip_flag = IGZIP_DEFLATE;
  }

  void move(std::span<const std::byte> from, std::uint8_t* to, std::size_t room) {
    stream.next_in = bytes_of(from);
    stream.avail_in = short_size(from.size());
    stream.next_out = to;
    stream.avail_out = short_size(room);
  }
};

Igzip::Igzip() : state_(std::make_unique<State>()) {}
Igzip::~Igzip() = default;

std::size_t Igzip::bound(std::size_t size) {
  return size + kStoredHeaderBytes * (size / kLongestStored + 1) + kEndBytes * (size / kMostAtOnce + 1);
}

std::byte* Igzip::put(std::span<const std::byte> bytes, bool last, std::byte* out) {
  for (; bytes.size() > kMostAtOnce; bytes = bytes.subspan(kMostAtOnce))
    out = put_piece(bytes.first(kMostAtOnce), false, out);
  return put_piece(bytes, last, out);
}

std::byte* Igzip::put_piece(std::span<const std::byte> bytes, bool last, std::byte* out) {
  isal_zstream& stream = state_->stream;
  isal_deflate_init(&stream);
  state_->use_level_1();
  stream.flush = FULL_FLUSH;
  stream.end_of_stream = last ? 1 : 0;
  state_->move(bytes, reinterpret_cast<std::uint8_t*>(out), bound(bytes.size()));
  const bool done = isal_deflate(&stream) == COMP_OK && stream.avail_in == 0 && stream.avail_out > 0;
  return done ? out + stream.total_out : put_stored_blocks(bytes, last, out);
}

bool Igzip::fits(std::span<const std::byte> bytes, std::size_t limit) {
  isal_zstream& stream = state_->stream;
  isal_deflate_stateless_init(&stream);
  state_->use_level_1();
  stream.flush = NO_FLUSH;
  stream.end_of_stream = 1;
  state_->move(bytes, state_->trial.data(), std::min(limit, state_->trial.size()));
  return isal_deflate_stateless(&stream) == COMP_OK;
}

std::byte* put_stored_blocks(std::span<const std::byte> bytes, bool last, std::byte* out) {
  do {
    const std::size_t size = std::min(bytes.size(), kLongestStored);
    *out++ = static_cast<std::byte>(last && size == bytes.size() ? 1 : 0);
    for (const std::size_t field : {size, ~size}) {
      *out++ = static_cast<std::byte>(field & 0xffU);
      *out++ = static_cast<std::byte>(field >> 8U & 0xffU);
    }
    out = std::copy_n(bytes.begin(), size, out);
    bytes = bytes.subspan(size);
  } while (!bytes.empty());
  return out;
}

}  // namespace landfall
