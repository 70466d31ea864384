// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cloud_files.h"

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

bool is_cloud(const std::string& name, const std::string& bytes) {
  const TemporaryFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return is_cloud_file(folder / name);
}

const std::string kGrid = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3\n4 5 6\n";

TEST(CloudReader, TheContentDecidesWhatIsACloud) {
  for (const std::string name : {"a.asc", "a", "a.tif", "a.xyz"}) {
    SCOPED_TRACE(name);
    EXPECT_TRUE(is_cloud(name, "//X Y Z Intensity\n-9.9 -9.8 -1 5\n1 2 3 4\n"));
    EXPECT_TRUE(is_cloud(name, "1 2 3\n4 5 6\n"));
    EXPECT_TRUE(is_cloud(name, "x,y,z\n1,2,3\n"));
    EXPECT_TRUE(is_cloud(name, "ply \r\nformat ascii 1.0\n"));
    EXPECT_TRUE(is_cloud(name, "# a comment\nVERSION .7\nFIELDS x y z\n"));
    EXPECT_TRUE(
        is_cloud(name, "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 2 3 0.5\n"));
  }
  for (const std::string name : {"a.asc", "a", "a.txt", "a.xyz", "a.dat", "a.grd"}) {
    SCOPED_TRACE(name);
    EXPECT_FALSE(is_cloud(name, kGrid));
    EXPECT_FALSE(is_cloud(name, "NCOLS 3\r\nNROWS 2\r\n"));
    EXPECT_FALSE(is_cloud(name, "DSAA\n3 2\n0 2\n0 1\n1 6\n1 2 3\n4 5 6\n"));
    EXPECT_FALSE(is_cloud(name, "north: 2\nsouth: 0\neast: 3\nwest: 0\nrows: 2\ncols: 3\n1 2 3\n4 5 6\n"));
    EXPECT_FALSE(is_cloud(name, std::string("II*\0\x08\0\0\0", 8)));
    EXPECT_FALSE(is_cloud(name, std::string("\0\0\0\1\0\2\0\3", 8)));
  }
  EXPECT_FALSE(is_cloud("a.vrt", "<VRTDataset rasterXSize=\"2\">\n"));
  EXPECT_FALSE(is_cloud("a.vrt", "<VRTDataset><GeoTransform>0, 1, 0, 13, 0, -1</GeoTransform></VRTDataset>"));
  EXPECT_FALSE(is_cloud("a.json", "{\"a\": 1, \"b\": [1, 2, 3, 4]}\n"));
  EXPECT_FALSE(is_cloud("a.hdr", "ENVI\nsamples = 3\nlines = 2\n"));
  EXPECT_FALSE(is_cloud("a.lbl", "PDS_VERSION_ID = PDS3\nRECORD_TYPE = FIXED_LENGTH\n"));
  EXPECT_FALSE(is_cloud("a.asc", "1 2\n3 4\n"));
  EXPECT_TRUE(is_cloud("a.csv", ""));              // refused as empty, not as a raster
  EXPECT_TRUE(is_cloud("a.csv", "\x1F\x8B\x08"));  // refused as compressed
  EXPECT_TRUE(is_cloud_file("/no/such/file.csv"));
  EXPECT_FALSE(is_cloud_file("/no/such/file.tif"));
}

TEST(CloudReader, ReadsAPlyAndAPcdWhoseFirstLineDiffers) {
  const std::string ply =
      "ply \nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float "
      "z\nend_header\n1 2 3\n";
  EXPECT_THAT(read_cloud("a", ply)[CloudField::z], ElementsAre(3));
  const std::string pcd =
      "# made by hand\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1 2 3\n";
  EXPECT_THAT(read_cloud("a", pcd)[CloudField::z], ElementsAre(3));
}

TEST(CloudReader, SaysThatCommasDoNotDivideValuesOfPcdAndPly) {
  const std::string pcd =
      "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 1\nHEIGHT 1\nDATA ascii\n1,2,3\n";
  EXPECT_THAT(cloud_refusal("a.pcd", pcd), HasSubstr("line 8: '1,2,3' is not a number: blanks must divide"));
}

TEST(CloudReader, NamesOfPlyAndPcdStateUnitsToo) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float lon\nproperty float lat\nproperty float "
      "z_ft\nend_header\n1 2 3\n";
  const CloudInfo info = read_cloud("a.ply", ply).info;
  EXPECT_EQ(info.units[0].kind, ColumnUnit::Kind::angle);
  EXPECT_EQ(info.units[2].factor, 0.3048);
}

}  // namespace
}  // namespace landfall
