// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/text/joined.h"
#include "base/text/key_unit.h"
#include "base/text/number_table.h"
#include "base/text/number_text.h"
#include "base/text/parsed_number.h"
#include "base/text/shown_text.h"
#include "refusal.h"

namespace landfall {
namespace {

using Outcome = ParsedNumber::Outcome;
using Words = std::vector<std::string>;
using namespace std::string_literals;

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

TEST(KeyUnit, IsTheSuffixOfTheName) {
  EXPECT_EQ(unit_of_key("scan.noise.range_sigma_m"), "m");
  EXPECT_EQ(unit_of_key("velocity_mps"), "m/s");
  EXPECT_EQ(unit_of_key("position_m_per_sqrt_s"), "m/s^0.5");
  EXPECT_EQ(unit_of_key("range_sigma_per_m"), "1");
  EXPECT_EQ(unit_of_key("torque_nm"), "N m");
  EXPECT_EQ(unit_of_key("force_n"), "N");
  EXPECT_EQ(unit_of_key("m"), "");
  EXPECT_EQ(unit_of_key("coverage.invalid_count"), "");
}

TEST(NumberTable, ColumnsAreOfOneLength) {
  EXPECT_EQ(NumberTable("a.csv", {{"t_s", {1, 2}}, {"x_m", {3, 4}}}).row_count(), 2U);
  EXPECT_EQ(NumberTable().row_count(), 0U);
  EXPECT_EQ(refusal<FormatError>([&] {
              const NumberTable table("a.csv", {{"t_s", {1, 2}}, {"x_m", {3}}});
            }),
            "a.csv: columns t_s and x_m differ in length");
}

TEST(NumberTable, RowsAreCountedFromOne) {
  EXPECT_EQ(refusal<FormatError>([&] { NumberTable("a.csv", {}).fail_at(0, "is odd"); }),
            "a.csv: row 1: is odd");
}

TEST(NumberText, Grouped) {
  EXPECT_EQ(grouped(0), "0");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1000), "1,000");
  EXPECT_EQ(grouped(12'960'000), "12,960,000");
  EXPECT_EQ(grouped(-999), "-999");
  EXPECT_EQ(grouped(-1234567), "-1,234,567");
  EXPECT_EQ(grouped(std::numeric_limits<std::int64_t>::min()), "-9,223,372,036,854,775,808");
}

TEST(NumberText, ShortNumbersHaveThreeDigitsAndCountsNoExponent) {
  EXPECT_EQ(short_number(0.000382009), "0.000382");
  EXPECT_EQ(short_number(11.12), "11.1");
  EXPECT_EQ(short_number(99.96), "100");
  EXPECT_EQ(short_number(785321), "785321");
  EXPECT_EQ(short_number(-1423), "-1423");
  EXPECT_EQ(short_number(INFINITY), "inf");
  EXPECT_EQ(percent_text(0.5), "50 %");
}

TEST(NumberText, ReadsBackAsTheSameDouble) {
  EXPECT_EQ(number_text(0.7), "0.7");
  EXPECT_EQ(std::stod(number_text(1.0 / 3)), 1.0 / 3);
}

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

TEST(ShownText, KeepsWhatIsPrintedAsItIs) {
  for (const std::string text :
       {"", "scan.h5", "m s-1", "Höhe 50 µm², 高さ", "a\\b \"c\" 'd'", "\xf0\x9f\x8c\x99"})
    EXPECT_EQ(shown_text(text), text);
}

TEST(ShownText, EscapesControlCharacters) {
  EXPECT_EQ(shown_text("no\x1b[31m.h5"), "no\\u001b[31m.h5");
  EXPECT_EQ(shown_text("a\nb\tc\r\x07\x7f"), "a\\u000ab\\u0009c\\u000d\\u0007\\u007f");
  EXPECT_EQ(shown_text("a\0b"s), "a\\u0000b");
  EXPECT_EQ(shown_text("\xc2\x9b"
                       "31m\xc2\x80\xc2\x9f\xc2\xa0"),
            "\\u009b31m\\u0080\\u009f\xc2\xa0");
}

TEST(ShownText, EscapesWhatReversesHidesOrImitates) {
  EXPECT_EQ(shown_text("a\u202e5h\u202c"), "a\\u202e5h\\u202c");
  EXPECT_EQ(shown_text("\u2066\u2069\u200e\u200f\u061c"), "\\u2066\\u2069\\u200e\\u200f\\u061c");
  EXPECT_EQ(shown_text("\u2028\u2029\u200b\u200d\u2060\u00ad\ufeff"),
            "\\u2028\\u2029\\u200b\\u200d\\u2060\\u00ad\\ufeff");
  EXPECT_EQ(shown_text("\u2010\u2027\u202f\u205f\u2070"),
            "\u2010\u2027\u202f\u205f\u2070");  // the neighbours
}

TEST(ShownText, EscapesBytesThatAreNotUtf8) {
  EXPECT_EQ(shown_text("\xff\xc0\x9b"), "\\xff\\xc0\\x9b");           // an ESC in too many bytes
  EXPECT_EQ(shown_text("\xe2\x80"), "\\xe2\\x80");                    // cut
  EXPECT_EQ(shown_text("\xed\xa0\x80"), "\\xed\\xa0\\x80");           // a surrogate
  EXPECT_EQ(shown_text("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond Unicode
  EXPECT_EQ(shown_text("\xe0\x82\x9b"), "\\xe0\\x82\\x9b");
}

TEST(ShownLines, KeepsLineFeedsAlone) {
  EXPECT_EQ(shown_lines("{\n \"a\": \x1b\r\n}"), "{\n \"a\": \\u001b\\u000d\n}");
}

}  // namespace
}  // namespace landfall
