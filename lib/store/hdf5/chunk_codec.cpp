// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_codec.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string_view>

#include "base/core/error.h"
#include "store/hdf5/chunk_filters.h"
#include "store/hdf5/h5.h"

namespace landfall {
namespace {

using Bytes = std::span<const std::byte>;

struct Compressor {
  int level = 0;
  std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> codec{nullptr,
                                                                                 libdeflate_free_compressor};
};

/// One compressor per thread: making one costs more than a small chunk.
libdeflate_compressor* compressor_for(int level) {
  thread_local Compressor compressor;
  if (compressor.level != level || !compressor.codec) {
    compressor.codec.reset(libdeflate_alloc_compressor(level));
    compressor.level = level;
    if (!compressor.codec) throw IoError("no memory for a compressor");
  }
  return compressor.codec.get();
}

/// True if compressing a sample from the middle saves less than a sixteenth.
bool looks_like_noise(Bytes plane, libdeflate_compressor* codec) {
  constexpr std::size_t kSample = 4096;
  std::array<std::byte, kSample> target;
  const Bytes sample = plane.subspan((plane.size() - kSample) / 2, kSample);
  return libdeflate_deflate_compress(codec, sample.data(), sample.size(), target.data(),
                                     kSample - kSample / 16) == 0;
}

/// True if pieces of the plane occur again within the reach of deflate: noise that is repeated, for example
/// by pulses that all measure the same.
bool repeats(Bytes plane) {
  constexpr std::size_t kProbes = 4;
  constexpr std::size_t kPieceBytes = 8;
  constexpr std::size_t kReach = 32768;
  const std::string_view text(reinterpret_cast<const char*>(plane.data()), plane.size());
  for (std::size_t i = 1; i <= kProbes; ++i) {
    const std::size_t at = plane.size() * i / kProbes - kPieceBytes;
    const std::size_t begin = at - std::min(at, kReach);
    if (text.substr(begin, at - begin).find(text.substr(at, kPieceBytes)) != std::string_view::npos)
      return true;
  }
  return false;
}

/// The bytes of neighbouring planes that hold noise.
struct NoiseRun {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// The first such planes. The last plane, of signs and exponents, is not counted as noise.
NoiseRun noise_run(Bytes planes, std::size_t element_size, int level, libdeflate_compressor* codec) {
  constexpr int kThoroughLevel = 6;
  constexpr std::size_t kShortPlane = 8192;
  const std::size_t size = planes.size() / element_size;
  if (level >= kThoroughLevel || size < kShortPlane) return {};
  const auto is_noise = [&](std::size_t i) {
    return looks_like_noise(planes.subspan(i * size, size), codec);
  };
  std::size_t begin = 0;
  while (begin + 1 < element_size && !is_noise(begin)) ++begin;
  if (begin + 1 == element_size || repeats(planes.subspan(begin * size, size))) return {};
  std::size_t end = begin + 1;
  while (end + 1 < element_size && is_noise(end)) ++end;
  return {begin * size, end * size};
}

/// zlib's compressor, made once per thread. Unlike libdeflate's, it can end at a byte within a stream.
class FlushingCompressor {
 public:
  FlushingCompressor() {
    // Only run lengths and Huffman coding: below noise lie zeros, or few values of a rounded number.
    if (deflateInit2(&stream_, 1, Z_DEFLATED, -MAX_WBITS, 8, Z_RLE) != Z_OK)
      throw IoError("no memory for a compressor");
  }
  ~FlushingCompressor() { deflateEnd(&stream_); }
  FlushingCompressor(const FlushingCompressor&) = delete;
  FlushingCompressor& operator=(const FlushingCompressor&) = delete;

  /// Writes deflate blocks that end at a byte; none of them is marked as the last.
  std::byte* put(Bytes bytes, std::byte* out, std::size_t room) {
    deflateReset(&stream_);
    stream_.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));  // only read
    stream_.avail_in = static_cast<uInt>(bytes.size());
    stream_.next_out = reinterpret_cast<Bytef*>(out);
    stream_.avail_out = static_cast<uInt>(room);
    if (deflate(&stream_, Z_FULL_FLUSH) != Z_OK || stream_.avail_in > 0 || stream_.avail_out == 0)
      throw IoError("compressing a chunk failed");
    return out + stream_.total_out;
  }

  static std::size_t bound(std::size_t size) { return compressBound(size) + 64; }

 private:
  z_stream stream_{};
};

constexpr std::size_t kStreamHeader = 2;
constexpr std::size_t kStreamChecksum = 4;
constexpr std::size_t kLongestBlock = 65535;

/// The bytes that stored blocks have besides those stored.
std::size_t block_headers(std::size_t size) { return 5 * (size / kLongestBlock + 1); }

enum class Last { no, yes };

/// Writes deflate's stored blocks (RFC 1951, 3.2.4), which end at a byte; whether they end the stream is
/// marked in the last of them.
std::byte* put_stored_blocks(Bytes bytes, Last last, std::byte* out) {
  while (!bytes.empty()) {
    const std::size_t size = std::min(bytes.size(), kLongestBlock);
    *out++ = std::byte{last == Last::yes && size == bytes.size()};
    for (const std::size_t field : {size, ~size}) {
      *out++ = static_cast<std::byte>(field & 0xffU);
      *out++ = static_cast<std::byte>(field >> 8U & 0xffU);
    }
    out = std::copy_n(bytes.begin(), size, out);
    bytes = bytes.subspan(size);
  }
  return out;
}

std::byte* put_stream_header(std::byte* out) {
  *out++ = std::byte{0x78};
  *out++ = std::byte{0x01};
  return out;
}

/// The checksum of the stream's bytes before compression.
std::byte* put_stream_checksum(Bytes bytes, std::byte* out) {
  const std::uint32_t checksum = libdeflate_adler32(1, bytes.data(), bytes.size());
  for (const unsigned shift : {24U, 16U, 8U, 0U}) *out++ = static_cast<std::byte>(checksum >> shift & 0xffU);
  return out;
}

/// Writes a zlib stream (RFC 1950) to the first bytes of `room`: the noise is stored, the bytes before and
/// after it are compressed.
std::span<const std::byte> put_zlib_stream(Bytes bytes, const NoiseRun& noise, libdeflate_compressor* codec,
                                           std::vector<std::byte>& room) {
  const Bytes stored = bytes.subspan(noise.begin, noise.end - noise.begin);
  const Bytes behind = bytes.subspan(noise.end);
  const std::size_t before_bound = noise.begin > 0 ? FlushingCompressor::bound(noise.begin) : 0;
  const std::size_t max_bytes = kStreamHeader + before_bound + stored.size() + block_headers(stored.size()) +
                                libdeflate_deflate_compress_bound(codec, behind.size()) + kStreamChecksum;
  if (room.size() < max_bytes) room.resize(max_bytes);
  std::byte* out = put_stream_header(room.data());
  if (noise.begin > 0) {
    thread_local FlushingCompressor flushing;
    out = flushing.put(bytes.first(noise.begin), out, before_bound);
  }
  out = put_stored_blocks(stored, Last::no, out);
  const std::size_t left = room.size() - static_cast<std::size_t>(out - room.data()) - kStreamChecksum;
  const std::size_t size = libdeflate_deflate_compress(codec, behind.data(), behind.size(), out, left);
  if (size == 0) throw IoError("compressing a chunk failed");
  return {room.data(), put_stream_checksum(bytes, out + size)};
}

/// The bytes before the zeros at the end; all, if there are few zeros.
Bytes without_zero_end(Bytes raw) {
  constexpr std::size_t kFew = 1024;
  const auto last = std::find_if(raw.rbegin(), raw.rend(), [](std::byte b) { return b != std::byte{0}; });
  const Bytes rest = raw.first(static_cast<std::size_t>(raw.rend() - last));
  return raw.size() - rest.size() < kFew ? raw : rest;
}

/// Writes a zlib stream in which the bytes are as they are, but for zeros at the end.
std::span<const std::byte> put_stored_stream(Bytes raw, std::vector<std::byte>& room) {
  const Bytes stored = without_zero_end(raw);
  const Bytes zeros = raw.subspan(stored.size());
  room.resize(kStreamHeader + raw.size() + block_headers(raw.size()) + kStreamChecksum);
  std::byte* out =
      put_stored_blocks(stored, zeros.empty() ? Last::yes : Last::no, put_stream_header(room.data()));
  if (!zeros.empty()) {
    const std::size_t size =
        libdeflate_deflate_compress(compressor_for(1), zeros.data(), zeros.size(), out, zeros.size());
    if (size == 0) throw IoError("compressing a chunk failed");
    out += size;
  }
  return {room.data(), put_stream_checksum(raw, out)};
}

}  // namespace

std::span<const std::byte> ChunkEncoder::encode(std::span<const std::byte> raw) {
  if (level_ == h5::kPlain) return raw;
  if (level_ == 0) return put_stored_stream(raw, stream_);
  thread_local std::vector<std::byte> room;
  if (room.size() < raw.size()) room.resize(raw.size());
  const std::span<std::byte> planes = std::span(room).first(raw.size());
  shuffle_bytes(raw, element_size_, planes);
  libdeflate_compressor* const codec = compressor_for(level_);
  return put_zlib_stream(planes, noise_run(planes, element_size_, level_, codec), codec, stream_);
}

}  // namespace landfall
