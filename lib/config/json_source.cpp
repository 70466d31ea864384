// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_source.h"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>

#include "base/error.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::string read_text(const std::string& path) {
  if (path == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::error_code error;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, error)) throw UsageError(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// nlohmann keeps the last of two equal keys; a configuration that says two things says neither.
class DuplicateKeyCheck {
 public:
  explicit DuplicateKeyCheck(const std::string& name) : name_(name) {}
  bool operator()(int /*depth*/, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) keys_.emplace_back();
    if (event == Json::parse_event_t::object_end) keys_.pop_back();
    if (event == Json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second)
      throw UsageError(name_ + ": key \"" + parsed.get<std::string>() + "\" stands twice in one object");
    return true;
  }

 private:
  std::string name_;
  std::vector<std::set<std::string>> keys_;
};

/// The parser's message without its prefix and in plain ASCII: it quotes the bytes that it could not read.
std::string plain_message(const std::string& message) {
  const std::size_t end = message.find("] ");
  std::string text = end == std::string::npos ? message : message.substr(end + 2);
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

Json parse(const std::string& text, const std::string& name) {
  try {
    return Json::parse(text, DuplicateKeyCheck(name));
  } catch (const Json::exception& error) {
    throw UsageError(name + ": not valid JSON: " + plain_message(error.what()));
  }
}

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> keys(1);
  for (const char c : path) {
    if (c == '.') {
      keys.emplace_back();
    } else {
      keys.back() += c;
    }
  }
  return keys;
}

Json& element(Json& array, const std::string& key, const std::string& assignment) {
  std::size_t index = 0;
  const auto [stop, error] = std::from_chars(key.data(), key.data() + key.size(), index);
  if (error != std::errc() || stop != key.data() + key.size() || index >= array.size())
    throw UsageError("--set " + assignment + ": '" + key + "' is no index of an array of " +
                     std::to_string(array.size()));
  return array[index];
}

void assign(Json& root, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError("--set " + assignment + ": wanted KEY=JSON");
  const std::string text = assignment.substr(equals + 1);
  if (!Json::accept(text))
    throw UsageError("--set " + assignment + ": '" + text + "' is not JSON (a text needs quotes: '\"" + text +
                     "\"')");
  const Json value = parse(text, "--set " + assignment);
  Json* target = &root;
  for (const std::string& key : split(assignment.substr(0, equals))) {
    if (key.empty()) throw UsageError("--set " + assignment + ": an empty key");
    if (target->is_null()) *target = Json::object();
    if (!target->is_structured())
      throw UsageError("--set " + assignment + ": '" + key + "' lies inside a plain value");
    target = target->is_array() ? &element(*target, key, assignment) : &(*target)[key];
  }
  *target = value;
}

}  // namespace

JsonSource read_json(const std::string& path) {
  if (path.empty()) return {"config", Json::object()};
  return parse_json(read_text(path), path == "-" ? "standard input" : path);
}

JsonSource parse_json(const std::string& text, const std::string& name) {
  Json value = parse(text, name);
  if (!value.is_object()) throw UsageError(name + ": the configuration must be a JSON object");
  return {name, std::move(value)};
}

void apply_assignments(JsonSource& source, const std::vector<std::string>& assignments) {
  for (const std::string& assignment : assignments) assign(source.value, assignment);
}

}  // namespace landfall
