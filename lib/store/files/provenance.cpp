// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D29
//
// Provenance with another structure is ignored. A configuration that is not an object, inputs without role
// and id, a history with such a step, and JSON of more than 100 levels are treated as absent, because any
// program may have written them; if a run needs them, it reports this with its own message.
#include "store/files/provenance.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/text/file_path.h"
#include "store/files/version.h"

namespace landfall {
namespace {

nlohmann::json inputs_json(const std::vector<InputRecord>& inputs) {
  nlohmann::json list = nlohmann::json::array();
  for (const InputRecord& input : inputs) {
    list.push_back({{"role", input.role}, {"file_id", input.file_id}});
    if (!input.assumed.empty()) list.back()["assumed"] = input.assumed;
  }
  return list;
}

}  // namespace

std::string program_version() { return LANDFALL_VERSION; }

std::string source_line(const std::string& tool) {
  return "landfall " + tool + " " LANDFALL_VERSION " (git " LANDFALL_GIT ")";
}

std::string Provenance::file_id() const {
  Hash hash;
  hash.update(program_version()).update(tool).update(config.dump());
  if (!options.is_null()) hash.update("options").update(options.dump());
  for (const InputRecord& input : inputs) hash.update(input.role).update(input.file_id);
  return hash.hex();
}

nlohmann::json Provenance::as_step() const {
  nlohmann::json step = {{"tool", tool},
                         {"version", program_version()},
                         {"file_id", file_id()},
                         {"config", config},
                         {"inputs", inputs_json(inputs)}};
  if (!options.is_null()) step["options"] = options;
  return step;
}

void Provenance::add_input(const std::string& role, const std::string& id,
                           const nlohmann::json& upstream_chain, std::vector<std::string> assumed) {
  inputs.push_back({role, id, std::move(assumed)});
  for (const nlohmann::json& step : upstream_chain)
    if (std::find(chain.begin(), chain.end(), step) == chain.end()) chain.push_back(step);
}

std::string maker_of(const nlohmann::json& chain) {
  return chain.is_array() && !chain.empty() && chain.back().is_object() ? chain.back().value("tool", "") : "";
}

bool is_imported(const nlohmann::json& chain) {
  return std::ranges::any_of(
      chain, [](const nlohmann::json& step) { return step.value("tool", "") == "landfall-import"; });
}

std::string content_id(const std::filesystem::path& path) {
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FormatError(path.string() + ": cannot be read");
  Hash hash;
  std::vector<char> buffer(std::size_t{1} << 20U);
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hash.update(std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(stream.gcount()))));
  }
  if (stream.bad()) throw FormatError(path.string() + ": reading failed");
  return hash.hex();
}

}  // namespace landfall
