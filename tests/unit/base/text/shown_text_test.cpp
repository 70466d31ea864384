// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/shown_text.h"

#include <gtest/gtest.h>

namespace landfall {
namespace {

using namespace std::string_literals;

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
