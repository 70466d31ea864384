// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/guard/file_seal.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "base/core/error.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/guard/file_screening.h"
#include "store/hdf5/table.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

class FileSeal : public testing::Test {
 protected:
  FileSeal() {
    LandfallFileWriter writer({path_, true, 0}, "scan", {.tool = "test"});
    const std::vector<double> values(1000, 1.5);
    const std::array<ColumnRows, 1> rows = {std::span<const double>(values)};
    write_table(writer.root(), "points", {{"x", h5::Type::float64, "m", "x"}}, rows, 0);
    writer.commit();
    std::ifstream stream(path_, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(stream), {});
  }

  void write(const std::string& bytes) const { std::ofstream(path_, std::ios::binary) << bytes; }
  [[nodiscard]] h5::Seal seal() const { return h5::seal_of(h5::RawFile(path_), unsealed().size()); }
  /// The file without its seal, which lies behind one range of chunks.
  [[nodiscard]] std::string unsealed() const { return bytes_.substr(0, bytes_.size() - 16 - 80); }

  /// The bytes of the one chunk.
  [[nodiscard]] std::pair<std::size_t, std::size_t> chunk_range() const {
    const h5::Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
    const h5::Handle column(H5Dopen2(file.get(), "points/x", H5P_DEFAULT), H5Dclose);
    const h5::Handle space(H5Dget_space(column.get()), H5Sclose);
    haddr_t begin = 0;
    hsize_t size = 0;
    EXPECT_GE(H5Dget_chunk_info(column.get(), space.get(), 0, nullptr, nullptr, &begin, &size), 0);
    return {begin, begin + size};
  }

  const TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_ / "a.h5";
  std::string bytes_;
};

TEST_F(FileSeal, IsIntactAsWritten) { EXPECT_EQ(seal(), h5::Seal::intact); }

TEST_F(FileSeal, ShowsAnyFlippedBitThatIsNotInAChunk) {
  const auto [chunk, chunk_end] = chunk_range();
  ASSERT_EQ(bytes_[chunk], 0x78);  // a zlib stream
  std::size_t damages = 0;
  for (std::size_t i = 0; i < bytes_.size(); i += 7) {
    if (i >= chunk && i < chunk_end) i = chunk_end;
    std::string damaged = bytes_;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
    write(damaged);
    ASSERT_EQ(seal(), h5::Seal::broken) << "byte " << i;
    ++damages;
  }
  EXPECT_GT(damages, 300U);
}

TEST_F(FileSeal, IsNotNeeded) {
  write(unsealed());
  EXPECT_EQ(seal(), h5::Seal::none);
  EXPECT_NO_THROW(LandfallFileReader(path_, {"scan"}));
}

TEST_F(FileSeal, IsNotTruncated) {
  for (std::size_t size = unsealed().size() + 1; size < bytes_.size(); ++size) {
    write(bytes_.substr(0, size));
    ASSERT_EQ(seal(), h5::Seal::broken) << size;
    ASSERT_THROW(LandfallFileReader(path_, {"scan"}), FormatError) << size;
  }
}

TEST_F(FileSeal, OtherBytesMayFollow) {
  write(unsealed() + "other bytes");
  EXPECT_EQ(seal(), h5::Seal::none);
  EXPECT_NO_THROW(LandfallFileReader(path_, {"scan"}));
}

TEST_F(FileSeal, IsRemovedByHdf5) {
  h5::Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
  h5::write_attribute(file.get(), "remark", std::string("mine"));
  file.reset();
  EXPECT_EQ(seal(), h5::Seal::none);
  EXPECT_NO_THROW(LandfallFileReader(path_, {"scan"}));
}

TEST_F(FileSeal, WithoutItEachObjectIsChecked) {
  std::vector<haddr_t> objects;
  {
    const LandfallFileReader file(path_, {"scan"});
    objects = h5::object_addresses(file.root());
  }
  ASSERT_GT(objects.size(), 5U);
  for (const haddr_t address : objects) {
    std::string damaged = unsealed();
    damaged[address] = 9;  // version of the object's header
    write(damaged);
    const auto check = [&] { h5::MetadataGuard(path_).check(address, "/object"); };
    EXPECT_THROW(check(), FormatError) << address;
  }
}

}  // namespace
}  // namespace landfall
