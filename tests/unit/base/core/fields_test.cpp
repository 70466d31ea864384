// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

namespace landfall {
namespace {

using testing::ElementsAre;

struct Point {
  double x = 0;
  double y = 0;
  LANDFALL_FIELDS(x, y)
};

struct Shown {
  static constexpr bool kShownEmpty = true;
  int size = 7;
  Point centre;
  LANDFALL_FIELDS(size, centre)
};

struct Shape {
  std::optional<Point> corner;
  std::optional<Shown> inner;
  int last = 1;
  static void fields(auto& walk, auto& m) {
    walk.inside("outer", [&] { walk.all("corner, inner", std::tie(m.corner, m.inner)); });
    walk("last", m.last);
  }
};

/// "path=value" of each visited value.
struct List {
  std::vector<std::string>& lines;
  void operator()(const std::string& path, std::nullopt_t /*none*/) const { lines.push_back(path + "=none"); }
  void operator()(const std::string& path, const auto& value) const {
    lines.push_back(path + "=" + std::to_string(static_cast<int>(value)));
  }
};

std::vector<std::string> listed(const Shape& shape) {
  std::vector<std::string> lines;
  FieldWalk walk{List{lines}};
  Shape::fields(walk, shape);
  return lines;
}

TEST(FieldWalk, VisitsNestedValuesInTheirOrder) {
  EXPECT_THAT(listed({.corner = Point{1, 2}, .inner = Shown{3, {4, 5}}}),
              ElementsAre("outer.corner.x=1", "outer.corner.y=2", "outer.inner.size=3",
                          "outer.inner.centre.x=4", "outer.inner.centre.y=5", "last=1"));
}

TEST(FieldWalk, LeavesOutOrShowsWhatIsEmpty) {
  EXPECT_THAT(listed({}), ElementsAre("outer.inner.size=none", "outer.inner.centre.x=none",
                                      "outer.inner.centre.y=none", "last=1"));
}

/// Counts up, in all but the structs of one name.
struct Fill {
  int& next;
  std::string absent;
  [[nodiscard]] bool has(const std::string& path) const { return path != absent; }
  void operator()(const std::string& /*path*/, auto& value) const { value = ++next; }
};

TEST(FieldWalk, FillsOptionalStructsThatHaveValues) {
  for (const char* const absent : {"outer.corner", "outer.inner", ""}) {
    Shape shape;
    int next = 0;
    FieldWalk walk{Fill{next, absent}};
    Shape::fields(walk, shape);
    EXPECT_EQ(shape.corner.has_value(), std::string(absent) != "outer.corner");
    EXPECT_EQ(shape.inner.has_value(), std::string(absent) != "outer.inner");
    EXPECT_EQ(shape.last, next);
    EXPECT_EQ(next, *absent == '\0' ? 6 : shape.corner ? 3 : 4);
  }
}

}  // namespace
}  // namespace landfall
