// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/comparison_answer.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The own requirement `m` <= `limit` of a map with this value.
OrderedJson judged(double value, double limit = 10) {
  return {{"metric", "m"}, {"value", value}, {"limit", limit}, {"pass", value <= limit}, {"at_least", false}};
}

/// The answer for the own requirements "p" and "q".
OrderedJson answer(const std::pair<OrderedJson, OrderedJson>& p,
                   const std::pair<OrderedJson, OrderedJson>& q = {judged(1), judged(1)},
                   const char* changed_key = nullptr) {
  OrderedJson comparison = {{"kind", "evaluation"}, {"configuration", OrderedJson::array()}};
  comparison["requirements"] = {{{"name", "p"}, {"a", p.first}, {"b", p.second}},
                                {{"name", "q"}, {"a", q.first}, {"b", q.second}}};
  if (changed_key != nullptr)
    comparison["configuration"].push_back({{"tool", "dem-eval"}, {"key", changed_key}});
  return answer_of(comparison, OrderedJson::object(), OrderedJson::object());
}

TEST(ComparisonAnswer, VerdictsThenFailuresThenMargins) {
  const std::pair<OrderedJson, OrderedJson> fixed{judged(11), judged(9)}, broken{judged(9), judged(11)};
  EXPECT_EQ(answer(fixed)["sentence"], "B is better: better in p; worse in nothing");
  EXPECT_EQ(answer(broken)["sentence"], "B is worse: worse in p; better in nothing");
  EXPECT_EQ(answer(fixed, broken)["sentence"], "B is mixed: better in p; worse in q");
  EXPECT_EQ(answer({judged(20), judged(15)}, {judged(9), judged(1)})["sentence"],
            "B is better: better in p; worse in nothing");
  EXPECT_EQ(answer({judged(2), judged(8)})["sentence"],
            "B is worse: worse by the margins of p; better by the margins of nothing");
  EXPECT_EQ(answer({judged(2), judged(2, 4)})["conclusion"], "worse") << "a larger share of the limit";
}

TEST(ComparisonAnswer, AChangeOfOnePercentIsNone) {
  EXPECT_EQ(answer({judged(5), judged(5.1)})["sentence"], "B is equal to A: no change of more than 1 %");
  EXPECT_EQ(answer({judged(5), judged(5.11)})["conclusion"], "worse");
  EXPECT_EQ(answer({judged(100), judged(101.1)})["conclusion"], "worse");
}

TEST(ComparisonAnswer, WhatOneFileDoesNotJudgeIsUnknown) {
  EXPECT_EQ(answer({judged(1), nullptr})["sentence"], "whether B is better is unknown for p");
  EXPECT_EQ(answer({judged(1), nullptr}, {judged(11), judged(9)})["sentence"],
            "B is better: better in q; worse in nothing; unknown for p");
  OrderedJson other = judged(9);
  other["metric"] = "n";
  EXPECT_EQ(answer({judged(11), other})["conclusion"], "unknown");
  EXPECT_EQ(answer({judged(11), other})["points"][0]["text"], "FAIL -> pass; A judges m, B n");
  EXPECT_EQ(answer({judged(1), judged(1)}, {judged(1), judged(1)}, "limits.hole_bins")["notes"],
            OrderedJson{"A and B are judged by different rules: limits.hole_bins"});
  EXPECT_TRUE(answer_of({{"kind", "scan"}}, {}, {}).is_null());
}

}  // namespace
}  // namespace landfall
