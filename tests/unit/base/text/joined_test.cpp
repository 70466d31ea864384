// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/joined.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

namespace landfall {
namespace {

using Words = std::vector<std::string>;

struct Item {
  std::string name;
  int count;
};

TEST(Joined, HasTheSeparatorBetweenWordsOnly) {
  EXPECT_EQ(joined(Words{}), "");
  EXPECT_EQ(joined(Words{"a"}), "a");
  EXPECT_EQ(joined(Words{"a", "b", "c"}), "a, b, c");
  EXPECT_EQ(joined(Words{"a", "b"}, " or "), "a or b");
  EXPECT_EQ(joined(std::array{"a", "b"}, ""), "ab");
}

TEST(Joined, TakesTheTextOfAnItemFromAMemberOrAFunction) {
  const std::vector<Item> items = {{"a", 1}, {"b", 0}, {"c", 2}};
  EXPECT_EQ(joined(items, ",", &Item::name), "a,b,c");
  const auto counted = [](const Item& item) {
    return item.count > 0 ? std::to_string(item.count) + item.name : "";
  };
  EXPECT_EQ(joined(items, "; ", counted), "1a; 2c");
}

TEST(Joined, LeavesOutEmptyTexts) {
  EXPECT_EQ(joined(Words{"", "a", "", "b", ""}), "a, b");
  EXPECT_EQ(joined(Words{"", ""}), "");
}

}  // namespace
}  // namespace landfall
