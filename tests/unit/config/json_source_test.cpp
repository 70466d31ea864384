// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace landfall {
namespace {

using testing::HasSubstr;

std::string write_temporary(const std::string& name, const std::string& text) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / name;
  std::ofstream(path) << text;
  return path.string();
}

std::string refusal(const std::string& text) {
  try {
    static_cast<void>(read_json(write_temporary("json_source_test.json", text)));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ReadJson, MissingFileAndWrongContent) {
  EXPECT_THROW(static_cast<void>(read_json("/nonexistent/a.json")), UsageError);
  EXPECT_THAT(refusal("{\"a\": 1,}"), HasSubstr("line 1, column 9"));
  EXPECT_THAT(refusal("[1]"), HasSubstr("must be a JSON object"));
  EXPECT_THAT(refusal(""), HasSubstr("not valid JSON"));
}

TEST(ReadJson, NanAndInfinityAreNotJson) {
  EXPECT_THAT(refusal("{\"a\": NaN}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("{\"a\": -Infinity}"), HasSubstr("not valid JSON"));
  EXPECT_THAT(refusal("{\"a\": 1e999}"), HasSubstr("not valid JSON"));
}

TEST(ReadJson, AKeyStandsOnce) {
  EXPECT_THAT(refusal("{\"a\": {\"b\": 1, \"b\": 2}}"), HasSubstr("\"b\" stands twice"));
  EXPECT_EQ(refusal("{\"a\": {\"b\": 1}, \"c\": {\"b\": 2}}"), "accepted");
}

TEST(Assignments, MakeReplaceAndIndex) {
  JsonSource source{"config", {{"list", {1, 2}}}};
  apply_assignments(source, {"a.b=1.5", "a.c=\"text\"", "list.1=7", "a.b=[1,2]"});
  EXPECT_EQ(source.value, nlohmann::json::parse(R"({"a": {"b": [1,2], "c": "text"}, "list": [1, 7]})"));
}

TEST(Assignments, RefuseWhatIsNoAssignment) {
  JsonSource source{"config", {{"list", {1, 2}}, {"x", 3}}};
  for (const char* const wrong : {"a", "=1", "a=text", "a=NaN", "a.=1", "list.2=1", "list.b=1", "x.y=1"})
    EXPECT_THROW(apply_assignments(source, {wrong}), UsageError) << wrong;
}

}  // namespace
}  // namespace landfall
