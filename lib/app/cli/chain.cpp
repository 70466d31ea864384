// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/chain.h"

#include <algorithm>
#include <utility>

#include "app/cli/meeting_options.h"
#include "base/text/number_text.h"

namespace landfall::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using Words = std::vector<std::string>;

/// A section as assignments of its keys.
void add_section(Words& words, const Json& section) {
  for (const auto& [key, value] : section.items())
    words.insert(words.end(), {"--set", key + "=" + value.dump()});
}

void add_outputs(ChainStage& stage, const fs::path& output,
                 const std::vector<std::pair<const char*, fs::path>>& sides) {
  stage.output = output;
  stage.arguments.insert(stage.arguments.end(), {"-o", output.string()});
  for (const auto& [option, path] : sides) {
    stage.arguments.insert(stage.arguments.end(), {option, path.string()});
    stage.side_outputs.push_back(path);
  }
}

ChainStage terrain_stage(const Json& config, const ChainRequest& request) {
  ChainStage stage{"terrain-gen", {}, {}};
  add_section(stage.arguments, config.at("terrain"));
  add_outputs(stage, request.folder / "terrain.h5", {});
  return stage;
}

/// A text that no shell changes.
std::string shell_word(const std::string& word) {
  const auto is_plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
           std::string_view("-_./,:=+@%").find(c) != std::string_view::npos;
  };
  if (!word.empty() && std::ranges::all_of(word, is_plain)) return word;
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? "'\\''" : std::string(1, c);
  return text + "'";
}

/// Adds the rules for files that meet to the stages that have such options.
std::vector<ChainStage> with_rules(std::vector<ChainStage> stages, const MeetingRules& rules) {
  const Words words = meeting_words(rules);
  for (ChainStage& stage : stages)
    if (stage.tool != "scan-sim") stage.arguments.insert(stage.arguments.end(), words.begin(), words.end());
  return stages;
}

}  // namespace

std::vector<ChainStage> chain_stages(const Json& config, const ChainRequest& request) {
  const fs::path& folder = request.folder;
  std::vector<ChainStage> stages = {terrain_stage(config, request)};
  const std::string terrain = stages.back().output.string();

  ChainStage& scan = stages.emplace_back(ChainStage{"scan-sim", {"--terrain", terrain}, {}});
  add_section(scan.arguments, config.at("scan"));
  add_outputs(scan, folder / "scan.h5", {});

  ChainStage& regrid =
      stages.emplace_back(ChainStage{"regrid", {(folder / "scan.h5").string(), "--terrain", terrain}, {}});
  if (config.at("uncertainty").get<bool>()) regrid.arguments.emplace_back("--uncertainty");
  add_section(regrid.arguments, config.at("regrid"));
  add_outputs(regrid, folder / "dem.h5", {});

  const std::string dem = (folder / "dem.h5").string();
  ChainStage& eval = stages.emplace_back(ChainStage{"dem-eval", {dem, "--table"}, {}});
  add_section(eval.arguments, config.at("eval"));
  add_outputs(eval, folder / "eval.h5",
              {{"--metrics", folder / "metrics.json"}, {"--report", folder / "report.html"}});
  if (request.require_pass) eval.requirement = "--require-pass";

  if (config.at("hazard").is_null()) return with_rules(std::move(stages), request.rules);
  ChainStage& hazards =
      stages.emplace_back(ChainStage{"hazard-map", {dem, "--terrain", terrain, "--table"}, {}});
  add_section(hazards.arguments, config.at("hazard"));
  add_outputs(hazards, folder / "hazards.h5",
              {{"--sites", folder / "sites.json"}, {"--report", folder / "hazards.html"}});
  if (request.require_safe) hazards.requirement = "--require-safe";
  return with_rules(std::move(stages), request.rules);
}

std::string shell_command(const ChainStage& stage) {
  std::string text = stage.tool;
  for (const std::string& word : stage.arguments) text += " " + shell_word(word);
  return stage.requirement.empty() ? text : text + " " + stage.requirement;
}

}  // namespace landfall::cli
