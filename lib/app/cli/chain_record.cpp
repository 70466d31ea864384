// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/chain_record.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <utility>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/output/output_path.h"
#include "base/text/file_path.h"
#include "base/text/joined.h"
#include "base/text/shown_text.h"
#include "store/config/path_names.h"
#include "store/config/resolved_config.h"
#include "store/config/stage_sections.h"
#include "store/files/json_leaves.h"
#include "store/files/landfall_file.h"
#include "store/files/provenance.h"

namespace landfall::cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kRecordName = ".landfall-run.json";
constexpr const char* kPreset = "preset:";
constexpr const char* kContent = "content ";
constexpr const char* kFrom = "--from ";

/// Identifies the content of a file: its file_id, or the hash of its bytes. Empty if it is an HDF5 file that
/// no tool of landfall has completed. `name`: that of the output, where the file is a temporary one.
std::string identity(const fs::path& path, const fs::path& name) {
  try {
    if (file_extension(name) == ".h5") return LandfallFileReader(path, kLandfallKinds).file_id();
    return content_id(path);
  } catch (const FormatError&) {
    return "";
  }
}

bool is_there(const fs::path& path) {
  std::error_code unreachable;
  return fs::exists(fs::symlink_status(path, unreachable));
}

/// Whether an output exists and has the identity that these identities give for its name.
bool is_in(const Json& identities, const fs::path& output) {
  const auto found = identities.find(output.filename().string());
  return found != identities.end() && found->is_string() && !found->get_ref<const std::string&>().empty() &&
         is_there(output) && *found == identity(output, output);
}

std::vector<fs::path> outputs_of(const ChainStage& stage) {
  std::vector<fs::path> outputs = stage.side_outputs;
  outputs.push_back(stage.output);
  return outputs;
}

/// The chain of a record; empty if it has none, or none of this form.
std::optional<ChainIdentity> chain_of(const Json& json) {
  if (!json.is_object() || !json.contains("config") || !json.contains("names") || !json["names"].is_array())
    return std::nullopt;
  ChainIdentity chain{{}, json["config"]};
  for (const Json& name : json["names"]) {
    if (!name.is_string()) return std::nullopt;
    chain.names.push_back(name);
  }
  return chain;
}

/// The path relative to the folder, after all links are followed. A name that is not a file, such as
/// NETCDF:"f.h5":z, stays.
fs::path from_folder(const fs::path& path, const fs::path& folder) {
  std::error_code failure;
  if (!fs::exists(path, failure)) return path;
  const fs::path target = fs::canonical(path, failure);
  if (failure) return path;
  const fs::path base = fs::canonical(folder, failure);
  return failure ? path : target.lexically_relative(base);
}

std::string shown_value(const std::optional<nlohmann::ordered_json>& value) {
  return value ? abbreviated(value->dump()) : "none";
}

/// The inputs of a step whose content differs, or which it has and the other one lacks.
std::string changed_inputs(const Json& before, const Json& after) {
  const auto ids_of = [](const Json& step) {
    std::map<std::string, std::string> ids;
    for (const Json& input : step.at("inputs"))
      ids[input.at("role")] += input.at("file_id").get<std::string>() + " ";
    return ids;
  };
  const auto earlier = ids_of(before);
  const auto later = ids_of(after);
  std::vector<std::string> words;
  for (const auto& [role, ids] : later) {
    const bool is_stage = role == "terrain" || role == "scan" || role == "dem";
    const auto found = earlier.find(role);
    if (found == earlier.end() || found->second != ids)
      words.push_back(role + (is_stage ? ".h5" : "") + (found == earlier.end() ? " is new" : " changed"));
  }
  return joined(words);
}

}  // namespace

ChainIdentity chain_identity(const ChainNames& names, const Json& config, const fs::path& folder) {
  ChainIdentity chain;
  for (const std::string& name : names.config_names) {
    const auto stream = names.streams.find(name);
    chain.names.push_back(stream != names.streams.end() ? kContent + Hash().update(stream->second).hex()
                          : name.starts_with(kPreset)   ? name
                                                        : from_folder(name, folder).string());
  }
  if (!names.from.empty()) chain.names.push_back(kFrom + from_folder(names.from, folder).string());
  chain.config = {{"uncertainty", config.at("uncertainty")}};
  for (const std::string& stage : stage_sections("chain")) {
    const Json& section = config.at(stage);
    chain.config[stage] = section.is_null() ? Json() : resolved_config({stage, section}, stage);
  }
  change_paths(chain.config, [&](const fs::path& path) { return from_folder(path, folder); });
  return chain;
}

std::string shown_names(const ChainIdentity& chain, const fs::path& folder) {
  if (chain.names.empty()) return "a chain of no -c";
  return joined(chain.names, " + ", [&](const std::string& name) {
    if (name.starts_with(kPreset)) return name;
    if (name.starts_with(kContent)) return std::string("standard input");
    const bool is_from = name.starts_with(kFrom);
    const std::string path = is_from ? name.substr(std::string_view(kFrom).size()) : name;
    return (is_from ? kFrom : "") + (folder / path).lexically_normal().string();
  });
}

std::string differences_text(const Json& before, const Json& after) {
  constexpr std::size_t kShown = 2;
  std::vector<ValuePair> pairs = value_pairs(before, after);
  std::erase_if(pairs, [](const ValuePair& pair) { return pair.a == pair.b; });
  std::stable_partition(pairs.begin(), pairs.end(), [](const ValuePair& pair) { return pair.a && pair.b; });
  std::vector<std::string> words;
  for (std::size_t i = 0; i < std::min(pairs.size(), kShown); ++i)
    words.push_back(pairs[i].path + " " + shown_value(pairs[i].a) + " -> " + shown_value(pairs[i].b));
  const std::size_t more = pairs.size() - words.size();
  if (more > 0) words.push_back("and " + std::to_string(more) + (more == 1 ? " more key" : " more keys"));
  return joined(words);
}

Json step_of(const fs::path& output) {
  try {
    return is_there(output) ? LandfallFileReader(output, kLandfallKinds).chain().back() : Json();
  } catch (const FormatError&) {  // another or a damaged file
    return nullptr;
  }
}

std::string replacement_reason(const Json& before, const Json& after) {
  if (before.is_null()) return "it was not a complete file of landfall";
  if (before.value("file_id", "") == after.value("file_id", "")) return "";
  const auto version = [](const Json& step) { return step.value("version", ""); };
  std::vector<std::string> words;
  const std::string options =
      differences_text(before.value("options", Json()), after.value("options", Json()));
  if (!options.empty()) words.push_back("option " + options);
  words.push_back(differences_text(before.value("config", Json()), after.value("config", Json())));
  if (before.at("inputs").is_array() && after.at("inputs").is_array())
    words.push_back(changed_inputs(before, after));
  if (version(before) != version(after))
    words.push_back("version " + version(before) + " -> " + version(after));
  const std::string text = joined(words, "; ");
  return text.empty() ? "its provenance differs" : text;
}

ChainRecord::ChainRecord(fs::path folder) : folder_(std::move(folder)) {
  std::ifstream file(folder_ / kRecordName);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("outputs") || !json["outputs"].is_object() ||
      !json.contains("stages") || !json["stages"].is_object())
    return;
  outputs_ = json["outputs"];
  stages_ = json["stages"];
  if (json.contains("announced") && json["announced"].is_object()) announced_ = json["announced"];
  chain_ = chain_of(json.value("chain", Json()));
}

bool ChainRecord::is_own(const fs::path& output) const { return is_in(outputs_, output); }

bool ChainRecord::is_announced(const fs::path& output) const { return is_in(announced_, output); }

bool ChainRecord::is_foreign(const fs::path& output) const {
  return is_there(output) && !is_own(output) && !is_announced(output);
}

std::string ChainRecord::table(const ChainStage& stage) const {
  if (!stages_.contains(stage.tool) || !stages_[stage.tool].is_object()) return "";
  const Json& table = stages_[stage.tool].value("table", Json());
  return table.is_string() ? table.get<std::string>() : "";
}

bool ChainRecord::has_met(const ChainStage& stage) const {
  if (!stages_.contains(stage.tool) || !stages_[stage.tool].is_object()) return false;
  return stages_[stage.tool].value("met", Json()) == Json(true);
}

void ChainRecord::announce(const ChainStage& stage) {
  announced_ = Json::object();
  for (const fs::path& output : outputs_of(stage))
    announced_[output.filename().string()] = identity(temporary_of(output), output);
  write();
}

void ChainRecord::add(const ChainStage& stage, const std::string& table, std::optional<bool> met) {
  for (const fs::path& output : outputs_of(stage))
    outputs_[output.filename().string()] = identity(output, output);
  announced_ = Json::object();
  stages_[stage.tool] = {{"table", table}, {"met", met ? Json(*met) : Json()}};
  write();
}

std::vector<std::string> ChainRecord::outputs() const {
  std::vector<std::string> names;
  for (const auto& [name, id] : outputs_.items())
    if (is_there(folder_ / name)) names.push_back(name);
  return names;
}

void ChainRecord::set_chain(ChainIdentity chain) {
  is_saved_ = chain_ && chain_->names == chain.names && chain_->config == chain.config;
  chain_ = std::move(chain);
}

void ChainRecord::save() {
  if (!is_saved_) write();
}

void ChainRecord::write() {
  Json json = {{"format", "landfall.run"}, {"outputs", outputs_}, {"stages", stages_}};
  if (!announced_.empty()) json["announced"] = announced_;
  if (chain_) json["chain"] = {{"names", chain_->names}, {"config", chain_->config}};
  OutputPath file(folder_ / kRecordName, true);
  write_text(file, json.dump(2) + "\n");
  file.commit();
  is_saved_ = true;
}

}  // namespace landfall::cli
