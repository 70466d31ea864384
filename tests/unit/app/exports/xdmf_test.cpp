// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/xdmf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "small_scan.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::HasSubstr;

TEST(Xdmf, NamesDataInOrBelowItsFolderRelatively) {
  EXPECT_EQ(xdmf_reference("/tmp/a/scan.h5", "/tmp/a/scan.xmf"), "scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/a/b/scan.h5", "/tmp/a/scan.xmf"), "b/scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/b/scan.h5", "/tmp/a/scan.xmf"), "/tmp/b/scan.h5");
  EXPECT_EQ(xdmf_reference("scan.h5", "other.xmf"), "scan.h5");
}

TEST(Xdmf, NamesDataFromTheFolderOfALinkThatItReplaces) {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder / "other");
  std::filesystem::create_symlink(folder / "other/old.xmf", folder / "scan.xmf");
  EXPECT_EQ(xdmf_reference(folder / "scan.h5", folder / "scan.xmf"), "scan.h5");
}

TEST(Xdmf, PlacesPointsByOneDatasetAndNamesThem) {
  const std::vector<ContentInfo> columns = {{"x_est", h5::Type::float32, "m", ""},
                                            {"status", h5::Type::int8, "1", ""}};
  const PointPositions positions{"a&b.h5", {"x_est", "y_est", "z_est"}, h5::Type::float32, 7, ""};
  EXPECT_EQ(xdmf_positions("c/p.xmf"), "c/p.xmf.h5");
  const std::string text = points_xdmf(columns, positions, "p.xmf.h5");
  EXPECT_THAT(text, HasSubstr(R"(TopologyType="Polyvertex" NumberOfElements="7")"));
  EXPECT_THAT(text,
              HasSubstr(R"(Dimensions="7 1" NumberType="Int" Precision="4" Format="HDF">p.xmf.h5:/row<)"));
  EXPECT_THAT(
      text,
      HasSubstr(R"(Dimensions="7 3" NumberType="Float" Precision="4" Format="HDF">p.xmf.h5:/position<)"));
  EXPECT_THAT(
      text,
      HasSubstr(R"(Dimensions="7" NumberType="Float" Precision="4" Format="HDF">a&amp;b.h5:/points/x_est<)"));
  EXPECT_THAT(text, HasSubstr(R"(NumberType="Char" Precision="1" Format="HDF">a&amp;b.h5:/points/status<)"));
}

TEST(Xdmf, ReadsThePlacesOfAScan) {
  const TemporaryFolder folder;
  SmallScan().write(folder / "scan.h5");
  const PointPositions positions = positions_of(PointReader(folder / "scan.h5"), "true", "s.h5");
  EXPECT_EQ(positions.columns, (std::array<std::string, 3>{"x_true", "y_true", "z_true"}));
  EXPECT_EQ(positions.type, h5::Type::float64);
  EXPECT_EQ(positions.rows, 5U);
  EXPECT_EQ(positions.scan, "s.h5");
}

TEST(Xdmf, PlacesAGridByOriginAndStepSlowestFirst) {
  const std::string text = grid_xdmf({{"count", h5::Type::int32, "1", ""}}, {0.5, -3, -4, 7, 9}, "d.h5");
  EXPECT_THAT(text, HasSubstr(R"(TopologyType="3DCoRectMesh" Dimensions="1 7 9")"));
  EXPECT_THAT(text, HasSubstr(">0 -1.5 -2<"));
  EXPECT_THAT(text,
              HasSubstr(R"(Dimensions="1 7 9" NumberType="Int" Precision="4" Format="HDF">d.h5:/count<)"));
}

}  // namespace
}  // namespace landfall
