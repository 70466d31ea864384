// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/own_requirement_config.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "base/core/error.h"
#include "base/dictionary/tables/requirements.h"
#include "base/text/shown_text.h"
#include "store/config/schema.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxName = 40;
/// The other rows of tables of requirements.
constexpr std::array kReserved = {"all", "all_and_own", "chosen_place_safe"};

/// A name is a part of paths and of names of columns.
bool is_valid_name(const std::string& name) {
  return !name.empty() && name.size() <= kMaxName && name.front() != ' ' && name.back() != ' ' &&
         std::ranges::all_of(name, [](unsigned char c) {
           return (c < 0x80 && std::isalnum(c) != 0) || c == '_' || c == '-' || c == ' ';
         });
}

bool is_taken(const std::string& name) {
  return std::ranges::find(kReserved, name) != kReserved.end() ||
         std::ranges::any_of(dictionary::kRequirements,
                             [&](const dictionary::Requirement& words) { return words.name == name; });
}

void check_name(const std::string& name, const std::string& where) {
  if (!is_valid_name(name))
    throw UsageError(where + "/name: " + abbreviated(Json(name).dump()) +
                     " is not 1 to 40 letters, digits, '_', '-' and spaces");
  if (is_taken(name)) throw UsageError(where + "/name: \"" + name + "\" is the name of another requirement");
}

void check_metric(const std::string& metric, const std::string& where, const ResultFields& result) {
  const auto found = std::ranges::find(result.fields, metric, &ResultField::path);
  if (found != result.fields.end() && found->is_number) return;
  const std::string refusal = where + "/metric: " + abbreviated(Json(metric).dump());
  if (found != result.fields.end()) throw UsageError(refusal + " of " + result.file + " is not a number");
  std::vector<std::string> numbers;
  for (const ResultField& field : result.fields)
    if (field.is_number) numbers.push_back(field.path);
  const auto inner = std::ranges::find_if(
      numbers, [&](const std::string& path) { return !metric.empty() && path.starts_with(metric + "."); });
  if (inner != numbers.end())
    throw UsageError(refusal + " of " + result.file + " is not a number; name one in it, such as \"" +
                     *inner + "\"");
  const std::string near = nearest_word(metric, numbers);
  throw UsageError(refusal + ": " + result.file + " has no such number" +
                   (near.empty() ? "" : "; did you mean \"" + near + "\"?"));
}

Requirement requirement_of(const Json& json, const std::string& where, const ResultFields& result) {
  Requirement requirement{.name = json.at("name"), .metric = json.at("metric")};
  check_name(requirement.name, where);
  check_metric(requirement.metric, where, result);
  const bool has_max = json.contains("max");
  requirement.at_least = json.contains("min");
  if (has_max == requirement.at_least)
    throw UsageError(where + ": " + (has_max ? "has both of max and min" : "has neither max nor min") +
                     "; give one of them");
  requirement.limit = json.at(has_max ? "max" : "min");
  return requirement;
}

}  // namespace

std::vector<Requirement> own_requirements(const Json& resolved, const std::string& where,
                                          const ResultFields& result) {
  std::vector<Requirement> requirements;
  if (!resolved.contains("requirements")) return requirements;
  const Json& list = resolved.at("requirements");
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string here = where + "/requirements/" + std::to_string(i);
    requirements.push_back(requirement_of(list[i], here, result));
    const std::string& name = requirements.back().name;
    if (std::ranges::count(requirements, name, &Requirement::name) > 1)
      throw UsageError(here + "/name: \"" + name + "\" is the name of another requirement");
  }
  return requirements;
}

}  // namespace landfall
