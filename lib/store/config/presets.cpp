// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/presets.h"

#include <filesystem>
#include <string_view>

#include "base/core/error.h"
#include "base/text/joined.h"
#include "base/text/shown_text.h"
#include "store/config/embedded_presets.h"
#include "store/config/schema.h"
#include "store/config/stage_sections.h"

namespace landfall {
namespace {

constexpr std::string_view kPrefix = "preset:";

/// The name of an embedded file NAME.SCHEMA.json; empty for a file of another schema.
std::string preset_name(std::string_view file, const std::string& schema) {
  const std::string ending = "." + schema + ".json";
  return file.ends_with(ending) ? std::string(file.substr(0, file.size() - ending.size())) : "";
}

JsonSource read_preset(const std::string& name, const std::string& schema) {
  std::vector<std::string> known;
  for (const auto& preset : embedded::kPresets) {
    const std::string found = preset_name(preset.name, schema);
    if (found == name && !name.empty()) return parse_json(preset.text, std::string(kPrefix) + name);
    if (!found.empty()) known.push_back(found);
  }
  const std::string near = nearest_word(name, known);
  throw UsageError(std::string(kPrefix) + abbreviated(name) + ": there is no such preset; " +
                   (known.empty()  ? "this tool has none"
                    : near.empty() ? "known: " + joined(known)
                                   : "did you mean " + std::string(kPrefix) + near + "?"));
}

/// Notes the keys of objects of `merged` that remain although `next` gives these objects another "type".
void note_leftovers(JsonSource& merged, const JsonSource& next, const nlohmann::json& changes,
                    const std::string& pointer) {
  const nlohmann::json::json_pointer where(pointer);
  if (!changes.is_object() || !merged.value.contains(where) || !merged.value.at(where).is_object()) return;
  const nlohmann::json& earlier = merged.value.at(where);
  if (changes.contains("type") && changes["type"] != earlier.value("type", nlohmann::json()))
    for (const auto& [key, unused] : earlier.items())
      merged.leftovers[(where / key).to_string()] = "it is left from " + merged.name + ": remove it in " +
                                                    next.name + " with \"" + key +
                                                    "\": null, or replace the whole object by --set";
  for (const auto& [key, inner] : changes.items())
    note_leftovers(merged, next, inner, (where / key).to_string());
}

JsonSource read_one(const std::string& name, const std::string& schema) {
  JsonSource source =
      name.starts_with(kPrefix) ? read_preset(name.substr(kPrefix.size()), schema) : read_json(name);
  if (has_stage_sections(schema)) expand_stage_sections(source, std::filesystem::path(name).parent_path());
  return source;
}

}  // namespace

std::vector<Preset> presets(const std::string& schema) {
  std::vector<Preset> found;
  for (const auto& preset : embedded::kPresets)
    if (const std::string name = preset_name(preset.name, schema); !name.empty())
      found.push_back({name, parse_json(preset.text, name).value.value("$comment", "")});
  return found;
}

JsonSource read_config(const std::vector<std::string>& names, const std::string& schema) {
  if (names.empty()) return read_json("");
  JsonSource merged = read_one(names.front(), schema);
  for (std::size_t i = 1; i < names.size(); ++i) {
    const JsonSource next = read_one(names[i], schema);
    note_leftovers(merged, next, next.value, "");
    merged.value.merge_patch(next.value);
    merged.streams.insert(next.streams.begin(), next.streams.end());
    merged.name += " + " + next.name;
  }
  return merged;
}

}  // namespace landfall
