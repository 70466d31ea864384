// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_codec.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <random>

#include "encoded_chunk.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

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

}  // namespace
}  // namespace landfall
