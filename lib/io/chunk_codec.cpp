// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/chunk_codec.h"

#include <libdeflate.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string_view>

#include "base/error.h"
#include "io/byte_shuffle.h"
#include "io/igzip.h"

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

/// True where a sample from the middle does not shrink by a sixteenth.
bool looks_like_noise(Bytes plane, Igzip& igzip) {
  constexpr std::size_t kSample = 4096;
  return !igzip.fits(plane.subspan((plane.size() - kSample) / 2, kSample), kSample - kSample / 16);
}

/// True where pieces of the plane are found once more as far back as deflate reaches: noise that comes again,
/// as in pulses that all see the same.
bool repeats(Bytes plane) {
  constexpr std::size_t kPieces = 4;
  constexpr std::size_t kPieceBytes = 8;
  constexpr std::size_t kReach = 32768;
  const std::string_view text(reinterpret_cast<const char*>(plane.data()), plane.size());
  for (std::size_t i = 1; i <= kPieces; ++i) {
    const std::size_t at = plane.size() * i / kPieces - kPieceBytes;
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

/// The first such planes. The last plane, of signs and exponents, counts as none.
NoiseRun noise_run(Bytes planes, std::size_t element_size, int level, Igzip& igzip) {
  constexpr int kThoroughLevel = 6;
  constexpr std::size_t kShortPlane = 8192;
  const std::size_t size = planes.size() / element_size;
  if (level >= kThoroughLevel || size < kShortPlane) return {};
  const auto is_noise = [&](std::size_t i) {
    return looks_like_noise(planes.subspan(i * size, size), igzip);
  };
  std::size_t begin = 0;
  while (begin + 1 < element_size && !is_noise(begin)) ++begin;
  if (begin + 1 == element_size || repeats(planes.subspan(begin * size, size))) return {};
  std::size_t end = begin + 1;
  while (end + 1 < element_size && is_noise(end)) ++end;
  return {begin * size, end * size};
}

constexpr std::size_t kHeaderBytes = 2;
constexpr std::size_t kChecksumBytes = 4;
constexpr int kQuickLevel = 1;

/// What stands behind the noise: the end of the stream.
std::byte* put_last(Bytes bytes, std::size_t plane_size, int level, Igzip& igzip, std::span<std::byte> room) {
  if (level == kQuickLevel) {
    std::byte* out = room.data();
    for (; bytes.size() > plane_size; bytes = bytes.subspan(plane_size))
      out = igzip.put(bytes.first(plane_size), false, out);
    return igzip.put(bytes, true, out);
  }
  const std::size_t size = libdeflate_deflate_compress(compressor_for(level), bytes.data(), bytes.size(),
                                                       room.data(), room.size());
  if (size == 0) throw IoError("compressing a chunk failed");
  return room.data() + size;
}

std::size_t last_bound(std::size_t size, std::size_t element_size, int level) {
  if (level == kQuickLevel) return element_size * Igzip::bound(size / element_size + 1);
  return libdeflate_deflate_compress_bound(compressor_for(level), size);
}

/// A zlib stream (RFC 1950) in the first bytes of `room`: the noise as it is, what lies before and behind it
/// compressed.
std::span<const std::byte> put_zlib_stream(Bytes bytes, std::size_t element_size, int level,
                                           std::vector<std::byte>& room) {
  thread_local Igzip igzip;
  const NoiseRun noise = noise_run(bytes, element_size, level, igzip);
  const Bytes behind = bytes.subspan(noise.end);
  const std::size_t most = kHeaderBytes + 2 * Igzip::bound(noise.end) +
                           last_bound(behind.size(), element_size, level) + kChecksumBytes;
  if (room.size() < most) room.resize(most);
  room[0] = std::byte{0x78};
  room[1] = std::byte{0x01};
  std::byte* out = room.data() + kHeaderBytes;
  if (noise.begin > 0) out = igzip.put(bytes.first(noise.begin), false, out);
  if (noise.end > noise.begin)
    out = put_stored_blocks(bytes.subspan(noise.begin, noise.end - noise.begin), false, out);
  const std::size_t left = room.size() - static_cast<std::size_t>(out - room.data()) - kChecksumBytes;
  out = put_last(behind, bytes.size() / element_size, level, igzip, {out, left});
  const std::uint32_t checksum = libdeflate_adler32(1, bytes.data(), bytes.size());
  for (const unsigned shift : {24U, 16U, 8U, 0U}) *out++ = static_cast<std::byte>(checksum >> shift & 0xffU);
  return {room.data(), out};
}

}  // namespace

std::span<const std::byte> ChunkEncoder::encode(std::span<const std::byte> raw) {
  if (level_ == 0) return raw;
  thread_local std::vector<std::byte> room;
  if (room.size() < raw.size()) room.resize(raw.size());
  const std::span<std::byte> planes = std::span(room).first(raw.size());
  shuffle_bytes(raw, element_size_, planes);
  return put_zlib_stream(planes, element_size_, level_, stream_);
}

}  // namespace landfall
