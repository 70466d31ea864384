// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/mesh/up_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace landfall {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(UpAxis, ReadsCommentsThatSayThatYIsUp) {
  for (const char* const text :
       {"# Blender v2.93 OBJ File: ''\nv 0 0 0\n", "ply\ncomment y up\nend_header\n", "# Y-up, metres\n",
        "ply\nformat ascii 1.0\nobj_info up_axis Y\n", "// up axis: +Y\n", "#Y is up\n",
        "# up = Y\r\nv 1 1 1", "v 1 2 3\n# axis up: y"})
    EXPECT_NE(place_comments(text).y_up, "") << text;
  for (const char* const text :
       {"", "v 0 0 0\n", "# z up\n", "comment Created by Blender\n", "# Blender 3.6\n# up_axis Z\n",
        "# supply of y upper\n", "ply\nend_header\n# y up\n", "# x, y, z\n", "Blender y up\n"})
    EXPECT_EQ(place_comments(text).y_up, "") << text;
  EXPECT_EQ(place_comments("#a\n# y up by me\n").y_up, "# y up by me");
}

TEST(UpAxis, ReadsCommentsWithAnOffset) {
  for (const char* const text :
       {"comment offset 500000 5400000 300\n", "# Global shift: (-500000.00, -5400000, 0)\n",
        "// translation = 0,5e5,0\n", "obj_info origin 1 2\n"})
    EXPECT_NE(place_comments(text).offset, "") << text;
  for (const char* const text :
       {"comment offset 0 0 0\n", "# offset of 3 columns\n", "# shift\n", "offset 1 2 3\n"})
    EXPECT_EQ(place_comments(text).offset, "") << text;
}

TEST(UpAxis, TellsReliefThatStandsOnEdge) {
  EXPECT_TRUE(stands_on_edge({20, 2, 20}));
  EXPECT_TRUE(stands_on_edge({20, 2, 9}));
  EXPECT_FALSE(stands_on_edge({20, 20, 2}));
  EXPECT_FALSE(stands_on_edge({20, 6, 20}));
  EXPECT_FALSE(stands_on_edge({1000, 5, 30}));  // a swath
  EXPECT_FALSE(stands_on_edge({0, 0, 0}));
}

TEST(UpAxis, WarnsUnlessTheAxisIsGiven) {
  const PlaceComments comments{.y_up = "# y up", .offset = "# offset 1 2 3"};
  EXPECT_THAT(place_warnings(comments, true, false, ": add it"),
              ElementsAre(HasSubstr("'# y up' says that y is up"),
                          "its comment '# offset 1 2 3' is not applied: add it"));
  EXPECT_THAT(place_warnings({}, true, false, ""), ElementsAre(HasSubstr("--up y")));
  EXPECT_THAT(place_warnings({.y_up = "# y up", .offset = ""}, true, true, ""), IsEmpty());
  EXPECT_THAT(place_warnings({}, false, false, ""), IsEmpty());
}

}  // namespace
}  // namespace landfall
