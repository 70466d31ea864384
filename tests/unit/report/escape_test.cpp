// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/escape.h"

#include <gtest/gtest.h>

#include <cmath>

namespace landfall::html_report {
namespace {

std::string base64_of(const std::string& text) { return base64(std::as_bytes(std::span(text))); }

TEST(HtmlText, TurnsMarkupIntoReferences) {
  EXPECT_EQ(html_text("<b class=\"a\">R&D's</b>"), "&lt;b class=&quot;a&quot;&gt;R&amp;D&#39;s&lt;/b&gt;");
  EXPECT_EQ(html_text("plain"), "plain");
}

TEST(ScriptJson, CannotEndItsElement) {
  const nlohmann::ordered_json value = {{"path", "</script><!--"}};
  const std::string text = script_json(value);
  EXPECT_EQ(text.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::ordered_json::parse(text), value);
}

TEST(ScriptJson, HasNullForNumbersThatAreNotFiniteAndReplacesBrokenText) {
  EXPECT_EQ(script_json({{"a", std::nan("")}}), "{\"a\":null}");
  EXPECT_EQ(script_json({{"a", "\xff"}}), "{\"a\":\"\xEF\xBF\xBD\"}");
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
