// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/xdmf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landfall {
namespace {

using testing::HasSubstr;

TEST(Xdmf, NamesDataInOrBelowItsFolderRelatively) {
  EXPECT_EQ(xdmf_reference("/tmp/a/scan.h5", "/tmp/a/scan.xmf"), "scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/a/b/scan.h5", "/tmp/a/scan.xmf"), "b/scan.h5");
  EXPECT_EQ(xdmf_reference("/tmp/b/scan.h5", "/tmp/a/scan.xmf"), "/tmp/b/scan.h5");
  EXPECT_EQ(xdmf_reference("scan.h5", "other.xmf"), "scan.h5");
}

TEST(Xdmf, PlacesPointsByThreeColumns) {
  const std::vector<ContentInfo> columns = {{"x_est", h5::Type::float64, "m", ""},
                                            {"y_est", h5::Type::float32, "m", ""},
                                            {"z_est", h5::Type::float64, "m", ""},
                                            {"status", h5::Type::int8, "1", ""}};
  const std::string text = points_xdmf(columns, 7, "est", "a&b.h5");
  EXPECT_THAT(text, HasSubstr(R"(TopologyType="Polyvertex" NumberOfElements="7")"));
  EXPECT_THAT(
      text,
      HasSubstr(R"(Dimensions="7" NumberType="Float" Precision="4" Format="HDF">a&amp;b.h5:/points/y_est<)"));
  EXPECT_THAT(text, HasSubstr(R"(NumberType="Char" Precision="1" Format="HDF">a&amp;b.h5:/points/status<)"));
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
