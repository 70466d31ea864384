// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/igzip.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <random>
#include <vector>

namespace landfall {
namespace {

using Bytes = std::vector<std::byte>;

constexpr std::uint32_t kSeed = 20261122;

/// Bytes that take so many values.
Bytes random_bytes(std::size_t size, unsigned values) {
  std::mt19937 random(kSeed);
  std::uniform_int_distribution<unsigned> value(0, values - 1);
  Bytes bytes(size);
  for (std::byte& byte : bytes) byte = static_cast<std::byte>(value(random));
  return bytes;
}

/// What zlib, another implementation, makes of a whole stream of deflate blocks.
Bytes inflated(const Bytes& stream, std::size_t size) {
  Bytes out(size + 1);
  z_stream inflater{};
  EXPECT_EQ(inflateInit2(&inflater, -MAX_WBITS), Z_OK);
  inflater.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(stream.data()));
  inflater.avail_in = static_cast<uInt>(stream.size());
  inflater.next_out = reinterpret_cast<Bytef*>(out.data());
  inflater.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(inflate(&inflater, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(inflater.avail_in, 0U);
  out.resize(inflater.total_out);
  inflateEnd(&inflater);
  return out;
}

/// All in pieces of one size, the last one shorter.
Bytes deflated(Igzip& igzip, const Bytes& bytes, std::size_t piece) {
  Bytes stream(Igzip::bound(bytes.size()) + (bytes.size() / piece + 1) * Igzip::bound(0));
  std::byte* out = stream.data();
  std::span<const std::byte> rest = bytes;
  for (; rest.size() > piece; rest = rest.subspan(piece)) out = igzip.put(rest.first(piece), false, out);
  out = igzip.put(rest, true, out);
  stream.resize(static_cast<std::size_t>(out - stream.data()));
  return stream;
}

TEST(Igzip, ZlibReadsWhatItWrites) {
  Igzip igzip;
  for (const unsigned values : {1U, 2U, 100U, 256U})
    for (const std::size_t size : {0UL, 1UL, 300UL, 65535UL, 65536UL, 131071UL, 1000003UL})
      for (const std::size_t piece : {65536UL, 8192UL, 1UL << 20U}) {
        const Bytes bytes = random_bytes(size, values);
        const Bytes stream = deflated(igzip, bytes, piece);
        EXPECT_EQ(inflated(stream, size), bytes) << size << " bytes of " << values << ", pieces of " << piece;
        const std::size_t pieces = size / piece + 1;
        EXPECT_LE(stream.size(), size + pieces * (Igzip::bound(piece) - piece)) << size << " " << values;
      }
}

TEST(Igzip, ShrinksWhatCanBe) {
  Igzip igzip;
  EXPECT_LT(deflated(igzip, random_bytes(65536, 2), 65536).size(), 65536U / 7);
  EXPECT_LT(deflated(igzip, Bytes(65536), 65536).size(), 500U);
}

// What was compressed before leaves no trace: the same bytes again.
TEST(Igzip, BytesDependOnTheInputAlone) {
  Igzip used;
  static_cast<void>(deflated(used, random_bytes(100000, 7), 65536));
  EXPECT_TRUE(used.fits(Bytes(5000), 1000));
  Igzip fresh;
  const Bytes bytes = random_bytes(70000, 30);
  EXPECT_EQ(deflated(used, bytes, 65536), deflated(fresh, bytes, 65536));
}

TEST(Igzip, TellsWhatFits) {
  Igzip igzip;
  EXPECT_TRUE(igzip.fits(Bytes(4096), 200));
  EXPECT_FALSE(igzip.fits(random_bytes(4096, 256), 4090));
  EXPECT_FALSE(igzip.fits(random_bytes(65536, 256), 65536));
  const Bytes half = random_bytes(4096, 16);
  EXPECT_TRUE(igzip.fits(half, 2300));
  EXPECT_FALSE(igzip.fits(half, 2000));
}

TEST(StoredBlocks, ZlibReadsThem) {
  for (const std::size_t size : {0UL, 1UL, 65535UL, 65536UL, 200000UL}) {
    const Bytes bytes = random_bytes(size, 256);
    Bytes stream(Igzip::bound(size));
    stream.resize(static_cast<std::size_t>(put_stored_blocks(bytes, true, stream.data()) - stream.data()));
    EXPECT_EQ(inflated(stream, size), bytes) << size;
  }
}

}  // namespace
}  // namespace landfall
