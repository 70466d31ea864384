// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "base/core/error.h"
#include "encoded_chunk.h"
#include "refusal.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/chunk_check.h"
#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/chunk_decoder.h"
#include "store/hdf5/chunk_filters.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using Filters = std::function<void(hid_t properties)>;

/// A file with a dataset of 5 x 7 numbers, 3.5 each, in chunks of 2 x 3.
class ChunkCheck : public testing::Test {
 protected:
  static constexpr hsize_t kSize[2] = {5, 7};
  static constexpr hsize_t kChunk[2] = {2, 3};

  void make(const Filters& filters) {
    h5::initialise();
    dataset_ = {};
    file_ = {};
    file_ = h5::create_file(folder_ / "a.h5");
    const h5::Handle space(H5Screate_simple(2, kSize, nullptr), H5Sclose);
    const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(properties.get(), 2, kChunk);
    filters(properties.get());
    dataset_ = h5::Handle(
        H5Dcreate2(file_.get(), "z", H5T_IEEE_F64BE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
        H5Dclose);
    const std::vector<double> values(35, 3.5);
    H5Dwrite(dataset_.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Fflush(file_.get(), H5F_SCOPE_GLOBAL);
  }

  /// Puts other bytes in the place of the chunk that begins at (2, 3).
  void replace(const std::function<void(StoredChunk& chunk)>& change) {
    const hsize_t offset[2] = {2, 3};
    StoredChunk chunk;
    ASSERT_TRUE(load_chunk(dataset_.get(), offset, chunk));
    change(chunk);
    ASSERT_GE(H5Dwrite_chunk(dataset_.get(), H5P_DEFAULT, chunk.filter_mask, offset, chunk.bytes.size(),
                             chunk.bytes.data()),
              0);
  }

  /// A selection of one value.
  [[nodiscard]] h5::Handle at(hsize_t row, hsize_t col) const {
    h5::Handle space(H5Dget_space(dataset_.get()), H5Sclose);
    const hsize_t start[2] = {row, col};
    const hsize_t count[2] = {1, 1};
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, count, nullptr);
    return space;
  }

  [[nodiscard]] bool reads() const {
    std::vector<double> values(35);
    return h5::read_values(dataset_.get(), H5T_NATIVE_DOUBLE, values.data()) &&
           values == std::vector<double>(35, 3.5);
  }

  TemporaryFolder folder_;
  h5::Handle file_;
  h5::Handle dataset_;
};

const Filters kNone = [](hid_t) {};
const Filters kDeflate = [](hid_t p) { H5Pset_deflate(p, 1); };
const Filters kAll = [](hid_t p) { H5Pset_shuffle(p), H5Pset_deflate(p, 1), H5Pset_fletcher32(p); };
const Filters kChecksumFirst = [](hid_t p) { H5Pset_fletcher32(p), H5Pset_shuffle(p), H5Pset_deflate(p, 1); };

TEST_F(ChunkCheck, WholeChunksPass) {
  for (const Filters& filters : {kNone, kDeflate, kAll, kChecksumFirst}) {
    make(filters);
    EXPECT_TRUE(chunks_are_whole(dataset_.get(), H5S_ALL));
    EXPECT_TRUE(reads());
    EXPECT_FALSE(undecodable_filter(dataset_.get()));
  }
}

// Without filters HDF5 takes the bytes of a chunk from the file, whatever was written there.
TEST_F(ChunkCheck, AChunkThatIsShortIsSeenWhereItIsTouched) {
  for (const Filters& filters : {kDeflate, kAll, kChecksumFirst}) {
    make(filters);
    replace([](StoredChunk& chunk) { chunk.bytes.pop_back(); });
    EXPECT_FALSE(chunks_are_whole(dataset_.get(), H5S_ALL));
    EXPECT_FALSE(reads());
    for (const auto& [row, col] : {std::pair<hsize_t, hsize_t>{2, 3}, {3, 5}})
      EXPECT_FALSE(chunks_are_whole(dataset_.get(), at(row, col).get()));
    for (const auto& [row, col] : {std::pair<hsize_t, hsize_t>{0, 0}, {1, 3}, {2, 2}, {2, 6}, {4, 4}})
      EXPECT_TRUE(chunks_are_whole(dataset_.get(), at(row, col).get())) << row << " " << col;
  }
}

// A stream that is right in itself, of 8 bytes instead of 48: HDF5 1.10 reads 40 bytes from behind it.
TEST_F(ChunkCheck, AStreamOfFewerValuesIsSeen) {
  make(kDeflate);
  replace([](StoredChunk& chunk) {
    const unsigned char eight_zeros[] = {0x78, 0x9c, 0x63, 0x60, 0x80, 0x00, 0x00, 0x00, 0x08, 0x00, 0x01};
    const auto* const bytes = reinterpret_cast<const std::byte*>(eight_zeros);
    chunk.bytes.assign(bytes, bytes + sizeof eight_zeros);
  });
  EXPECT_FALSE(chunks_are_whole(dataset_.get(), H5S_ALL));
  EXPECT_FALSE(reads());
}

TEST_F(ChunkCheck, AFilterThatWasLeftOutIsNotUndone) {
  make(kAll);
  replace([](StoredChunk& chunk) {
    chunk.filter_mask = 7;
    chunk.bytes.assign(48, std::byte{0});
  });
  EXPECT_TRUE(chunks_are_whole(dataset_.get(), H5S_ALL));
  replace([](StoredChunk& chunk) { chunk.bytes.pop_back(); });
  EXPECT_FALSE(chunks_are_whole(dataset_.get(), H5S_ALL));
}

TEST_F(ChunkCheck, OtherFiltersAreRefused) {
  make([](hid_t p) { H5Pset_scaleoffset(p, H5Z_SO_FLOAT_DSCALE, 1); });
  EXPECT_EQ(undecodable_filter(dataset_.get()), "6 (scaleoffset)");
  make([](hid_t p) { H5Pset_deflate(p, 1), H5Pset_shuffle(p); });
  EXPECT_EQ(undecodable_filter(dataset_.get()), "2 (shuffle)");
  make([](hid_t p) { H5Pset_deflate(p, 1), H5Pset_deflate(p, 1); });
  EXPECT_EQ(undecodable_filter(dataset_.get()), "1 (deflate)");
  make([](hid_t p) { H5Pset_scaleoffset(p, H5Z_SO_FLOAT_DSCALE, 1); });
  EXPECT_THAT(refusal<FormatError>([&] { return reads(); }),
              testing::HasSubstr("a.h5: /z is stored by filter 6 (scaleoffset)"));
}

TEST_F(ChunkCheck, ChunksThatAreNotThereAreFine) {
  make(kDeflate);
  const h5::Handle properties(H5Dget_create_plist(dataset_.get()), H5Pclose);
  const h5::Handle space(H5Dget_space(dataset_.get()), H5Sclose);
  const h5::Handle empty(H5Dcreate2(file_.get(), "empty", H5T_IEEE_F64LE, space.get(), H5P_DEFAULT,
                                    properties.get(), H5P_DEFAULT),
                         H5Dclose);
  EXPECT_TRUE(chunks_are_whole(empty.get(), H5S_ALL));
}

constexpr std::uint32_t kSeed = 20261121;

/// Ranges of about 500 m with noise: two quiet bytes, six noisy ones.
std::vector<double> noisy(std::size_t count) {
  std::mt19937_64 random(kSeed);
  std::normal_distribution<double> noise(500, 0.02);
  std::vector<double> values(count);
  for (double& value : values) value = noise(random);
  return values;
}

std::vector<double> repeated(const std::vector<double>& period, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = period[i % period.size()];
  return values;
}

std::size_t encoded_size(const std::vector<double>& values, int level) {
  return encode_chunk(std::as_bytes(std::span(values)), sizeof(double), level).size();
}

/// The chunks as HDF5's own filters, built on zlib, decode them.
std::vector<double> through_hdf5(const std::vector<double>& values, int level) {
  const TemporaryFolder folder;
  LandfallFileWriter writer({folder / "a.h5", true, level}, "scan", {.tool = "test"});
  const std::array<ColumnRows, 1> rows = {std::span<const double>(values)};
  write_table(writer.root(), "points", {{"x", h5::Type::float64, "m", "x"}}, rows, level);
  writer.commit();
  const LandfallFileReader reader(folder / "a.h5", {"scan"});
  const TableReader table(reader.root(), "points", reader.name());
  std::vector<double> read(values.size());
  EXPECT_GE(H5Dread(table.open("x").get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, read.data()), 0);
  return read;
}

TEST(ChunkCodec, Hdf5ReadsStoredPlanes) {
  for (const std::size_t count : {1UL, 1000UL, kTableChunkRows - 1, kTableChunkRows, 2 * kTableChunkRows + 3})
    for (const int level : {0, 1, 5, 6, 9}) {
      const std::vector<double> values = noisy(count);
      EXPECT_EQ(through_hdf5(values, level), values) << count << " rows, level " << level;
    }
}

TEST(ChunkCodec, LevelZeroStoresNoRowsThatATableDoesNotHave) {
  const std::vector<double> values = noisy(12);
  std::vector<double> padded = values;
  padded.resize(kTableChunkRows);
  EXPECT_LT(encoded_size(padded, 0), 12 * sizeof(double) + 1000);
  EXPECT_EQ(encoded_size(values, 0), 12 * sizeof(double) + 2 + 5 + 4);  // header, one block, checksum
  for (const std::size_t count : {1UL, 12UL, kTableChunkRows - 128, kTableChunkRows - 127, kTableChunkRows})
    EXPECT_EQ(through_hdf5(noisy(count), 0), noisy(count)) << count;
  const std::vector<double> zeros(1000);
  EXPECT_EQ(through_hdf5(zeros, 0), zeros);
}

TEST(ChunkCodec, StoringNoiseCostsAlmostNothing) {
  const std::vector<double> values = noisy(kTableChunkRows);
  const std::size_t searched = encoded_size(values, 6);
  EXPECT_LT(searched, values.size() * 7);  // the two quiet bytes do shrink
  EXPECT_LT(encoded_size(values, 1), searched + searched / 50);
}

// Elevations near zero, as differences of ranges: their lowest bits are zeros, then comes the noise.
std::vector<double> small_differences(std::size_t count) {
  std::vector<double> values = noisy(count);
  for (double& value : values) value -= 500;
  return values;
}

TEST(ChunkCodec, NoiseBetweenQuietBytesIsStored) {
  const std::vector<double> values = small_differences(kTableChunkRows);
  EXPECT_EQ(through_hdf5(values, 1), values);
  EXPECT_LT(encoded_size(values, 1), values.size() * 6);
  EXPECT_LT(encoded_size(values, 1), encoded_size(values, 6) + values.size() / 4);
  for (const std::size_t count : {8191UL, 8192UL, 20001UL})
    EXPECT_EQ(through_hdf5(small_differences(count), 1), small_differences(count));
}

// The low bytes are noise to any sample, yet each pulse is a copy of the one before.
TEST(ChunkCodec, NoiseThatRepeatsIsFound) {
  for (const std::size_t period : {324U, 5000U, 16384U}) {
    const std::vector<double> values = repeated(noisy(period), kTableChunkRows);
    EXPECT_LT(encoded_size(values, 1), period * 8 + values.size() / 2) << period;
    EXPECT_EQ(through_hdf5(values, 1), values);
  }
}

TEST(ChunkCodec, SmoothColumnsShrinkAsBefore) {
  const std::vector<double> same(kTableChunkRows, 1.5);
  EXPECT_LT(encoded_size(same, 1), 5000U);
}

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
