// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/chunk_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <vector>

#include "base/core/error.h"
#include "refusal.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/h5.h"
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

}  // namespace
}  // namespace landfall
