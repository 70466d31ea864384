// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/escape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace landfall::html_report {
namespace {

std::string base64_of(const std::string& text) { return base64(std::as_bytes(std::span(text))); }

TEST(HtmlText, TurnsMarkupIntoReferences) {
  EXPECT_EQ(html_text("<b class=\"a\">R&D's</b>"), "&lt;b class=&quot;a&quot;&gt;R&amp;D&#39;s&lt;/b&gt;");
  EXPECT_EQ(html_text("plain"), "plain");
}

TEST(HtmlText, ShowsWhatWouldHideOrReverse) {
  EXPECT_EQ(html_text("a\x1b[31m\nb\u202ec"), "a\\u001b[31m\nb\\u202ec");
}

TEST(ScriptJson, ShowsWhatWouldHideOrReverse) {
  const nlohmann::ordered_json hostile = {{"key\u202e", {"a\x07", 1.5, nullptr, {{"b", "\u00e9\u200b"}}}}};
  const nlohmann::ordered_json shown = {{"key\\u202e", {"a\\u0007", 1.5, nullptr, {{"b", "\u00e9\\u200b"}}}}};
  EXPECT_EQ(nlohmann::ordered_json::parse(script_json(hostile)), shown);
}

TEST(ScriptJson, CannotEndItsElement) {
  const nlohmann::ordered_json value = {{"path", "</script><!--"}};
  const std::string text = script_json(value);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), value);
}

TEST(ScriptJson, HasNullForNumbersThatAreNotFiniteAndReplacesBrokenText) {
  EXPECT_EQ(script_json({{"a", std::nan("")}}), "{\"a\":null}");
  EXPECT_EQ(script_json({{"a", "\xff"}}), "{\"a\":\"\\\\xff\"}");
}

// RFC 4648, section 10.
TEST(Base64, IsTheStandardsExamples) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foob"), "Zm9vYg==");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}

}  // namespace
}  // namespace landfall::html_report
