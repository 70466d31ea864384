// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_source.h"

#include <cerrno>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <set>
#include <system_error>

#include "base/error.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::string read_text(const std::string& path) {
  if (path == "-") return {std::istreambuf_iterator<char>(std::cin), {}};
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw UsageError(path + ": no such file");
  if (std::filesystem::is_directory(path, error)) throw UsageError(path + ": is a directory");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UsageError(path + ": cannot be read: " + std::generic_category().message(errno));
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Deeper than any schema; what walks a configuration may call itself.
constexpr int kMostLevels = 64;

/// A key as a message can hold it.
std::string shown(const std::string& key) { return key.size() <= 60 ? key : key.substr(0, 57) + "..."; }

/// Refuses what is JSON and no configuration. nlohmann keeps the last of two equal keys; a configuration that
/// says two things says neither. A pass of its own: the parser's callbacks take time in the square of a list.
class StrictnessCheck final : public nlohmann::json_sax<Json> {
 public:
  explicit StrictnessCheck(const std::string& name) : name_(name) {}

  bool start_object(std::size_t /*size*/) override {
    keys_.emplace_back();
    return go_down();
  }
  bool key(std::string& text) override {
    if (!keys_.back().insert(text).second)
      throw UsageError(name_ + ": key \"" + shown(text) + "\" stands twice in one object");
    return true;
  }
  bool end_object() override {
    keys_.pop_back();
    return go_up();
  }
  bool start_array(std::size_t /*size*/) override { return go_down(); }
  bool end_array() override { return go_up(); }
  bool null() override { return true; }
  bool boolean(bool /*value*/) override { return true; }
  bool number_integer(Json::number_integer_t /*value*/) override { return true; }
  bool number_unsigned(Json::number_unsigned_t /*value*/) override { return true; }
  bool number_float(Json::number_float_t /*value*/, const std::string& /*text*/) override { return true; }
  bool string(std::string& /*value*/) override { return true; }
  bool binary(Json::binary_t& /*value*/) override { return true; }
  /// What is no JSON is told by parse().
  bool parse_error(std::size_t /*at*/, const std::string& /*token*/,
                   const nlohmann::detail::exception& /*error*/) override {
    return false;
  }

 private:
  bool go_down() {
    if (++level_ > kMostLevels)
      throw UsageError(name_ + ": is nested deeper than " + std::to_string(kMostLevels) + " levels");
    return true;
  }
  bool go_up() {
    --level_;
    return true;
  }

  std::string name_;
  int level_ = 0;
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
    StrictnessCheck check(name);
    Json::sax_parse(text, &check);
    return Json::parse(text);
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
  const std::vector<std::string> keys = split(assignment.substr(0, equals));
  if (keys.size() > std::size_t{kMostLevels})
    throw UsageError("--set: a key of " + std::to_string(keys.size()) + " parts, more than " +
                     std::to_string(kMostLevels));
  for (const std::string& key : keys) {
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
