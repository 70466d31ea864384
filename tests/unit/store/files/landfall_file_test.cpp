// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/landfall_file.h"

#include <gtest/gtest.h>

#include "store/files/stored_json.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// A file whose provenance has these texts in the place of its own.
LandfallFileReader with_provenance(const std::filesystem::path& path,
                                   const std::vector<std::pair<std::string, std::string>>& texts) {
  {
    LandfallFileWriter file({path, true}, "terrain", {.tool = "terrain-gen", .config = {{"a", 1}}});
    const h5::Handle group(H5Gopen2(file.root(), "provenance", H5P_DEFAULT), H5Gclose);
    for (const auto& [name, text] : texts) {
      H5Ldelete(group.get(), name.c_str(), H5P_DEFAULT);
      h5::write_text(group.get(), {name, "a text"}, text);
    }
    file.commit();
  }
  return {path, {"terrain"}};
}

// Whoever reads a configuration asks it for keys.
TEST(LandfallFile, AConfigurationIsAnObjectOrNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(with_provenance(folder / "a.h5", {}).config(), Json({{"a", 1}}));
  for (const char* const text : {"[1]", "5", "\"text\"", "{", ""})
    EXPECT_TRUE(with_provenance(folder / "a.h5", {{"config_json", text}}).config().is_null()) << text;
}

TEST(LandfallFile, InputsHaveARoleAndAnId) {
  const TemporaryFolder folder;
  const auto inputs = [&](const char* text) {
    return with_provenance(folder / "a.h5", {{"inputs_json", text}}).chain().back().at("inputs");
  };
  EXPECT_EQ(inputs(R"([{"role": "terrain", "file_id": "f"}])").size(), 1U);
  for (const char* const text :
       {"5", "{}", "[5]", R"([{"role": 5, "file_id": "f"}])", R"([{"role": "terrain"}])"})
    EXPECT_TRUE(inputs(text).is_null()) << text;
}

TEST(LandfallFile, AHistoryThatIsNotUnderstoodIsLeftOut) {
  const TemporaryFolder folder;
  const auto steps = [&](const std::string& text) {
    return with_provenance(folder / "a.h5", {{"chain_json", text}}).chain().size();
  };
  const std::string step = R"({"tool": "scan-sim", "file_id": "f")";
  EXPECT_EQ(steps("[" + step + "}]"), 2U);
  EXPECT_EQ(steps("[" + step + R"(, "version": "0.1", "inputs": []}])"), 2U);
  EXPECT_EQ(steps("[" + step + R"(, "version": 1}])"), 1U);
  EXPECT_EQ(steps("[" + step + R"(, "inputs": [{"role": 1, "file_id": "f"}]}])"), 1U);
}

// An attribute holds less than 64 KiB.
TEST(LandfallFile, HistoryHasALinePerStepUpToALimit) {
  const TemporaryFolder folder;
  const auto history = [&](std::size_t upstream) {
    Provenance made{.tool = "regrid"};
    for (std::size_t i = 0; i < upstream; ++i)
      made.chain.push_back({{"tool", "scan-sim"}, {"version", "0.1"}, {"file_id", "id" + std::to_string(i)}});
    LandfallFileWriter(OutputOptions{folder / "a.h5", true}, "dem", made).commit();
    return *h5::read_text_attribute(LandfallFileReader(folder / "a.h5", {"dem"}).root(), "history");
  };
  const std::string last =
      "landfall regrid " + program_version() + ", file_id " + Provenance{.tool = "regrid"}.file_id();
  EXPECT_EQ(history(0), last);
  EXPECT_EQ(history(1), "landfall scan-sim 0.1, file_id id0\n" + last);
  const std::string many = history(1000);
  EXPECT_TRUE(
      many.starts_with("801 earlier steps: /provenance/chain_json\nlandfall scan-sim 0.1, file_id id801\n"));
  EXPECT_TRUE(many.ends_with(last));
  EXPECT_LT(many.size(), 65536U);
}

TEST(LandfallFile, ClaimsCfUnlessThatIsWithdrawn) {
  const TemporaryFolder folder;
  for (const bool follows : {true, false}) {
    LandfallFileWriter file({folder / "a.h5", true}, "dem", {.tool = "test"});
    if (!follows) file.withdraw_cf_claim();
    file.commit();
    const LandfallFileReader read(folder / "a.h5", {"dem"});
    EXPECT_EQ(h5::read_text_attribute(read.root(), "Conventions").value_or("none"),
              follows ? "CF-1.8" : "none");
  }
}

// A function that walks JSON calls itself: 10^5 levels would end the program.
TEST(StoredJson, DeepTextsAreNone) {
  const auto nested = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_TRUE(is_storable_json(nested(kMaxStoredLevels)));
  EXPECT_FALSE(is_storable_json(nested(kMaxStoredLevels + 1)));
  EXPECT_FALSE(is_storable_json(std::string(1'000'000, '[')));
  std::string spaced = "[[],[],[]]";
  spaced.insert(1, 1000, ' ');
  EXPECT_TRUE(is_storable_json(spaced));
  EXPECT_TRUE(stored_json<Json>(nested(1'000'000)).is_null());
  EXPECT_TRUE(stored_json<Json>(std::nullopt).is_null());
  EXPECT_EQ(stored_json<Json>("{\"a\": 1}"), Json({{"a", 1}}));
}

}  // namespace
}  // namespace landfall
