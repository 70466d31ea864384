// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_decoder.h"

#include <gtest/gtest.h>

#include <vector>

#include "encoded_chunk.h"
#include "store/hdf5/chunk_filters.h"

namespace landfall {
namespace {

std::vector<std::byte> some_bytes(std::size_t count) {
  std::vector<std::byte> bytes(count);
  std::uint32_t state = 1;
  for (std::byte& b : bytes) b = static_cast<std::byte>((state = state * 1664525U + 1013904223U) >> 28U);
  return bytes;
}

// The definition: byte b of element i stands at b * count + i.
TEST(ByteShuffle, MatchesItsDefinitionForEverySize) {
  for (const std::size_t size : {1U, 2U, 3U, 4U, 5U, 8U, 16U})
    for (const std::size_t count : {0U, 1U, 15U, 16U, 17U, 31U, 64U, 257U}) {
      const std::vector<std::byte> elements = some_bytes(size * count);
      std::vector<std::byte> planes(elements.size());
      shuffle_bytes(elements, size, planes);
      for (std::size_t i = 0; i < count; ++i)
        for (std::size_t b = 0; b < size; ++b)
          ASSERT_EQ(planes[b * count + i], elements[i * size + b]) << size << " bytes, " << count;
    }
}

TEST(ByteShuffle, AnyPartComesBack) {
  for (const std::size_t size : {1U, 2U, 4U, 8U}) {
    const std::vector<std::byte> elements = some_bytes(size * 100);
    std::vector<std::byte> planes(elements.size());
    shuffle_bytes(elements, size, planes);
    for (const std::size_t first : {0U, 1U, 16U, 33U, 99U, 100U})
      for (std::size_t count = 0; first + count <= 100; count += 7) {
        std::vector<std::byte> part(size * count);
        unshuffle_bytes(planes, size, first, part);
        ASSERT_TRUE(std::equal(part.begin(), part.end(), elements.begin() + static_cast<long>(first * size)))
            << size << " bytes, [" << first << ", +" << count << ")";
      }
  }
}

class ChunkDecoder : public testing::Test {
 protected:
  const ChunkFormat format_{8, 1000, ChunkFilters::shuffle_deflate};
  const std::vector<std::byte> elements_ = some_bytes(8000);
  const std::vector<std::byte> stored_ = encode_chunk(elements_, 8, 1);
};

TEST_F(ChunkDecoder, GivesBackAnyPart) {
  for (const std::size_t first : {0U, 3U, 999U}) {
    std::vector<std::byte> part(8 * std::min<std::size_t>(1000 - first, 501));
    ASSERT_TRUE(decode_chunk(stored_, 0, format_, first, part));
    EXPECT_TRUE(std::equal(part.begin(), part.end(), elements_.begin() + static_cast<long>(8 * first)));
  }
}

TEST_F(ChunkDecoder, HonoursTheFilterMask) {
  std::vector<std::byte> planes(8000);
  shuffle_bytes(elements_, 8, planes);
  const std::vector<std::byte> only_deflated = encode_chunk(elements_, 1, 1);  // one plane: no shuffle
  std::vector<std::byte> out(8000);
  ASSERT_TRUE(decode_chunk(only_deflated, 1, format_, 0, out));
  EXPECT_EQ(out, elements_);
  ASSERT_TRUE(decode_chunk(planes, 2, format_, 0, out));
  EXPECT_EQ(out, elements_);
  ASSERT_TRUE(decode_chunk(elements_, 3, format_, 0, out));
  EXPECT_EQ(out, elements_);
  ASSERT_TRUE(decode_chunk(elements_, 0, {8, 1000, ChunkFilters::none}, 0, out));
  EXPECT_EQ(out, elements_);
}

// The bytes of level 0 lie in blocks of 65535, so that the header of one lies among them.
TEST(ChunkDecoderLevelZero, NoDamageChangesAValue) {
  std::vector<std::byte> elements(70000);
  for (std::size_t i = 0; i < elements.size(); ++i)
    elements[i] = std::byte(i % 3000 < 2900 ? 0 : i * 7 % 256);
  const ChunkFormat format{1, elements.size(), ChunkFilters::deflate};
  const std::vector<std::byte> stored = encode_chunk(elements, 8, 0);
  std::vector<std::byte> out(elements.size());
  ASSERT_TRUE(decode_chunk(stored, 0, format, 0, out));
  EXPECT_EQ(out, elements);
  std::vector<std::byte> part(10);
  ASSERT_TRUE(decode_chunk(stored, 0, format, 65530, part));
  EXPECT_TRUE(std::equal(part.begin(), part.end(), elements.begin() + 65530));
  ASSERT_TRUE(decode_chunk(elements, 1, format, 0, out)) << "a chunk without deflate, by the filter mask";
  EXPECT_EQ(out, elements);
  // A bit, an inverted 16-bit word (0000 is ffff to fletcher32), and erased blocks.
  const auto damage = [&](std::size_t begin, std::size_t size, auto change) {
    std::vector<std::byte> damaged = stored;
    for (std::size_t i = begin; i < std::min(begin + size, damaged.size()); ++i)
      damaged[i] = change(damaged[i]);
    if (decode_chunk(damaged, 0, format, 0, out)) {
      EXPECT_EQ(out, elements) << size << " from " << begin;
    }
  };
  for (std::size_t i = 0; i < stored.size(); i += (i < 100 || (i > 65500 && i < 65600)) ? 1 : 97) {
    damage(i, 1, [](std::byte b) { return b ^ std::byte{0x10}; });
    damage(i, 2, [](std::byte b) { return ~b; });
    for (const std::size_t size : {64U, 512U, 4096U, 65536U}) {
      damage(i, size, [](std::byte) { return std::byte{0xff}; });
      damage(i, size, [](std::byte) { return std::byte{0}; });
    }
  }
  EXPECT_FALSE(decode_chunk(std::span(stored).first(3), 0, format, 0, out));
  EXPECT_FALSE(decode_chunk(elements, 0, format, 0, out));
}

// Earlier versions stored level 0 so.
TEST_F(ChunkDecoder, ChecksFletcher32) {
  constexpr ChunkFormat kChecked{8, 1000, ChunkFilters::fletcher32};
  std::vector<std::byte> stored = elements_;
  for (const unsigned shift : {0U, 8U, 16U, 24U})
    stored.push_back(static_cast<std::byte>(fletcher32(elements_) >> shift & 0xffU));
  std::vector<std::byte> out(8000);
  ASSERT_TRUE(decode_chunk(stored, 0, kChecked, 0, out));
  EXPECT_EQ(out, elements_);
  ASSERT_TRUE(decode_chunk(elements_, 1, kChecked, 0, out))
      << "a chunk without its checksum, by the filter mask";
  for (std::size_t i = 0; i < stored.size(); ++i) {
    stored[i] ^= std::byte{0x40};
    EXPECT_FALSE(decode_chunk(stored, 0, kChecked, 0, out)) << "byte " << i;
    stored[i] ^= std::byte{0x40};
  }
  EXPECT_FALSE(decode_chunk(std::span(stored).first(3), 0, kChecked, 0, out));
  EXPECT_FALSE(decode_chunk(elements_, 0, kChecked, 0, out));
}

TEST_F(ChunkDecoder, RefusesWhatIsCorruptOrOfAnotherSize) {
  std::vector<std::byte> out(8);
  EXPECT_FALSE(decode_chunk(stored_, 0, {8, 999, ChunkFilters::shuffle_deflate}, 0, out));
  EXPECT_FALSE(decode_chunk(stored_, 0, {8, 1001, ChunkFilters::shuffle_deflate}, 0, out));
  EXPECT_FALSE(decode_chunk(elements_, 3, {8, 999, ChunkFilters::shuffle_deflate}, 0, out));
  EXPECT_FALSE(decode_chunk(elements_, 0, {8, 1001, ChunkFilters::none}, 0, out));
  EXPECT_FALSE(decode_chunk({}, 0, format_, 0, out));
  EXPECT_FALSE(decode_chunk(std::span(stored_).first(stored_.size() - 1), 0, format_, 0, out));
  for (std::size_t i = 0; i < stored_.size(); i += 97) {
    std::vector<std::byte> damaged = stored_;
    damaged[i] ^= std::byte{0x10};
    EXPECT_FALSE(decode_chunk(damaged, 0, format_, 0, out)) << "byte " << i;
  }
}

}  // namespace
}  // namespace landfall
