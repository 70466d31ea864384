// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_filters.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <random>
#include <vector>

#include "store/hdf5/h5.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

constexpr std::uint32_t kWordSeed = 20261123;

/// The definition: one word after the other, with end-around carry.
std::uint32_t reference(std::span<const std::byte> bytes) {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
  const auto carried = [](std::uint32_t sum) { return (sum & 0xffffU) + (sum >> 16U); };
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    const auto upper = std::to_integer<std::uint32_t>(bytes[i]);
    const auto lower = i + 1 < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + 1]) : 0;
    first = carried(first + (upper << 8U | lower));
    second = carried(second + first);
  }
  return second << 16U | first;
}

std::vector<std::byte> random_bytes(std::size_t count) {
  std::mt19937 random(kWordSeed);
  std::vector<std::byte> bytes(count);
  for (std::byte& b : bytes) b = static_cast<std::byte>(random());
  return bytes;
}

/// The checksum that HDF5's own filter appends to a chunk of these bytes.
std::uint32_t of_hdf5(const std::vector<std::byte>& bytes) {
  const TemporaryFolder folder;
  h5::initialise();
  const h5::Handle file = h5::create_file(folder / "a.h5");
  const hsize_t size = bytes.size();
  const h5::Handle space(H5Screate_simple(1, &size, nullptr), H5Sclose);
  const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_chunk(properties.get(), 1, &size);
  H5Pset_fletcher32(properties.get());
  const h5::Handle dataset(
      H5Dcreate2(file.get(), "x", H5T_STD_I8LE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
      H5Dclose);
  H5Dwrite(dataset.get(), H5T_NATIVE_INT8, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data());
  H5Fflush(file.get(), H5F_SCOPE_LOCAL);
  std::vector<std::byte> stored(bytes.size() + kFletcher32Bytes);
  const hsize_t offset = 0;
  std::uint32_t mask = 0;
  EXPECT_GE(H5Dread_chunk(dataset.get(), H5P_DEFAULT, &offset, &mask, stored.data()), 0);
  std::uint32_t checksum = 0;
  for (std::size_t i = 0; i < kFletcher32Bytes; ++i)
    checksum |= std::to_integer<std::uint32_t>(stored[bytes.size() + i]) << 8U * i;
  return checksum;
}

TEST(Fletcher32, MatchesItsDefinitionForEverySize) {
  const std::vector<std::byte> bytes = random_bytes(20000);
  for (const std::size_t size :
       {0U, 1U, 2U, 3U, 15U, 16U, 17U, 31U, 4095U, 4096U, 4097U, 8192U, 19999U, 20000U})
    EXPECT_EQ(fletcher32(std::span(bytes).first(size)), reference(std::span(bytes).first(size))) << size;
}

TEST(Fletcher32, CarriesAsTheDefinition) {
  for (const int value : {0x00, 0x01, 0x7f, 0xff})
    for (const std::size_t size : {2U, 16U, 5000U, 131070U, 600000U}) {
      const std::vector<std::byte> bytes(size, std::byte(value));
      EXPECT_EQ(fletcher32(bytes), reference(bytes)) << value << " " << size;
    }
}

TEST(Fletcher32, IsThatOfHdf5) {
  for (const std::size_t size : {1U, 2U, 999U, 70000U})
    EXPECT_EQ(fletcher32(random_bytes(size)), of_hdf5(random_bytes(size))) << size;
  const std::vector<std::byte> zeros(1000);
  EXPECT_EQ(fletcher32(zeros), of_hdf5(zeros));
  const std::vector<std::byte> ones(1000, std::byte{0xff});
  EXPECT_EQ(fletcher32(ones), of_hdf5(ones));
}

TEST(Fletcher32, ShowsEveryFlippedBit) {
  std::vector<std::byte> bytes = random_bytes(300);
  const std::uint32_t before = fletcher32(bytes);
  for (std::byte& b : bytes)
    for (unsigned bit = 0; bit < 8; ++bit) {
      b ^= std::byte{1} << bit;
      EXPECT_NE(fletcher32(bytes), before);
      b ^= std::byte{1} << bit;
    }
}

}  // namespace
}  // namespace landfall
