// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/parsed_number.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace landfall {
namespace {

using Outcome = ParsedNumber::Outcome;

double value_of(const std::string& text) {
  const ParsedNumber parsed = parsed_number(text);
  EXPECT_EQ(parsed.outcome, Outcome::number) << text;
  return parsed.value;
}

TEST(ParsedNumber, ReadsWhatProgramsWrite) {
  EXPECT_EQ(value_of("1.5"), 1.5);
  EXPECT_EQ(value_of("-.5e1"), -5);
  EXPECT_EQ(value_of("+1.0e0"), 1);
  EXPECT_EQ(value_of("+.5E-1"), 0.05);
  EXPECT_EQ(value_of("1.0D+00"), 1);
  EXPECT_EQ(value_of("-2.5d-1"), -0.25);
  EXPECT_EQ(value_of("0.1"), 0.1);
  EXPECT_EQ(value_of("5e-324"), 5e-324);
  EXPECT_TRUE(std::isnan(value_of("nan")));
  EXPECT_TRUE(std::isinf(value_of("+Inf")));
}

TEST(ParsedNumber, TinyNumbersAreZero) {
  for (const char* const text :
       {"1e-400", "+1E-400", "123456e-400", "0.0001e-330", "1e-99999999999999999999", "1D-400", "0e400"})
    EXPECT_EQ(value_of(text), 0) << text;
  EXPECT_EQ(value_of("0." + std::string(400, '0') + "1"), 0);
  EXPECT_EQ(value_of("0." + std::string(400, '0') + "1e2"), 0);
  EXPECT_TRUE(std::signbit(value_of("-1e-400")));
}

TEST(ParsedNumber, KnowsWhatIsTooLarge) {
  for (const char* const text : {"1e400", "-1e400", "0.001e500", "1e99999999999999999999", "+1D+400"})
    EXPECT_EQ(parsed_number(text).outcome, Outcome::too_large) << text;
  EXPECT_EQ(parsed_number("1" + std::string(400, '0')).outcome, Outcome::too_large);
  EXPECT_EQ(parsed_number(std::string(400, '9') + "e-10").outcome, Outcome::too_large);
}

TEST(ParsedNumber, RefusesTheRest) {
  for (const char* const text :
       {"", "+", "-", "+-1", "-+1", "++1", "1,5", "1.5m", "x", "1e", "1d", "0x10", "1 2", "d", "1.5.2"})
    EXPECT_EQ(parsed_number(text).outcome, Outcome::not_a_number) << text;
}

}  // namespace
}  // namespace landfall
