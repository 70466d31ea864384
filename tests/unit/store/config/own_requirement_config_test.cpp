// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/own_requirement_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "refusal.h"

namespace landfall {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A result with two numbers and a text.
const ResultFields kResult{"r.json", {{"a.first_m", true}, {"a.second_m", true}, {"shape", false}}};

std::vector<Requirement> parsed(const std::string& list) {
  return own_requirements(nlohmann::json::parse(R"({"requirements": )" + list + "}"), "c.json: ", kResult);
}

std::string refused(const std::string& list) {
  return refusal([&] { return parsed(list); });
}

TEST(OwnRequirementConfig, NoneWithoutTheKey) {
  EXPECT_THAT(own_requirements(nlohmann::json::object(), "c.json: ", kResult), IsEmpty());
}

TEST(OwnRequirementConfig, BoundsInOrder) {
  EXPECT_EQ(parsed(R"([{"name": "x y-1_", "metric": "a.first_m", "max": 2},
                       {"name": "z", "metric": "a.second_m", "min": -1}])"),
            (std::vector<Requirement>{{"x y-1_", "a.first_m", 2, false}, {"z", "a.second_m", -1, true}}));
}

TEST(OwnRequirementConfig, NamesArePartsOfPaths) {
  const auto name = [](const std::string& text) {
    return refused(R"([{"name": ")" + text + R"(", "metric": "a.first_m", "max": 1}])");
  };
  for (const std::string& bad : {std::string("a.b"), std::string("a/b"), std::string(" a"), std::string("a "),
                                 std::string("\u00e4"), std::string(41, 'a')})
    EXPECT_THAT(name(bad), HasSubstr("/requirements/0/name: \"")) << bad;
  EXPECT_EQ(name(std::string(40, 'a')), "accepted");
  for (const char* const taken :
       {"coverage", "absolute_horizontal", "all", "all_and_own", "chosen_place_safe"})
    EXPECT_THAT(name(taken), HasSubstr("is the name of another requirement")) << taken;
  EXPECT_EQ(refused(R"([{"name": "x", "metric": "a.first_m", "max": 1},
                        {"name": "x", "metric": "a.second_m", "max": 1}])"),
            R"(c.json: /requirements/1/name: "x" is the name of another requirement)");
}

}  // namespace
}  // namespace landfall
