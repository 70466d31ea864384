// SPDX-License-Identifier: GPL-3.0-or-later
// A configuration has at most 64 levels, more than any schema; a message cuts keys and values after 60
// characters and is always one line.
//
// An element of an array is set by its index (`--set navigation_error.velocity_mps.0=0.1`) where the array
// is in the configuration or its default; `scan` of a run of draws changes elements of the scan's own array.
//
// A configuration has at most 64 MiB. Half a million features take less; parsed, it needs several times
// its size. The limit is for devices and pipes without an end.
#include "store/config/json_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <set>
#include <string_view>
#include <system_error>

#include "base/core/error.h"
#include "base/core/standard_streams.h"
#include "base/text/file_path.h"
#include "base/text/json_text.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "store/config/config_path.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// The largest configuration. A device such as /dev/zero has no end.
constexpr std::size_t kMaxMebibytes = 64;

std::string read_to_end(std::istream& stream, const std::string& name) {
  std::string text;
  std::array<char, 4096> block;  // small, because the stack may be small (ulimit -s)
  while (stream.read(block.data(), block.size()), stream.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kMaxMebibytes << 20U)
      throw UsageError(name + ": is larger than " + std::to_string(kMaxMebibytes) +
                       " MiB, the limit of a configuration");
  }
  const bool failed = stream.bad() || (&stream == &std::cin && std::ferror(stdin) != 0);
  if (failed) throw UsageError(name + ": cannot be read completely");
  return text;
}

std::string read_text(const std::string& path) {
  if (path == "-") return read_to_end(standard_input(), "standard input");
  const std::filesystem::file_status status = status_of(path);
  if (!std::filesystem::exists(status)) throw UsageError(path + ": no such file");
  if (std::filesystem::is_directory(status)) throw UsageError(path + ": is a directory");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw UsageError(path + ": cannot be read: " + std::generic_category().message(errno));
  return read_to_end(stream, path);
}

/// More levels than any schema has. Code that walks a configuration may recurse.
constexpr int kMaxLevels = 64;

/// Refuses JSON that is not a configuration; parse() reports text that is not JSON. nlohmann keeps the last
/// of two equal keys, but a repeated key makes a configuration ambiguous. This is a separate pass because the
/// parser's callbacks take quadratic time for a list.
class StrictnessCheck final : public JsonLevels {
 public:
  explicit StrictnessCheck(std::string name) : JsonLevels(kMaxLevels), name_(std::move(name)) {}

  bool start_object(std::size_t size) override {
    keys_.emplace_back();
    return JsonLevels::start_object(size);
  }
  bool key(std::string& text) override {
    if (std::ranges::any_of(text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
      throw UsageError(name_ + ": key \"" + shown_word(text) + "\" has a control character (shown as ?)");
    if (!keys_.back().insert(text).second)
      throw UsageError(name_ + ": key \"" + abbreviated(text) + "\" is given twice in one object");
    return true;
  }
  bool end_object() override {
    keys_.pop_back();
    return JsonLevels::end_object();
  }

 private:
  bool too_deep() override {
    throw UsageError(name_ + ": is nested deeper than " + std::to_string(kMaxLevels) + " levels");
  }

  std::string name_;
  std::vector<std::set<std::string>> keys_;
};

/// The parser's message without its prefix and in plain ASCII: it quotes the bytes that it could not read, of
/// which the last ones are the most useful, or a number that is too large, of which the first ones are.
std::string plain_message(const std::string& message) {
  constexpr std::string_view kQuote = "last read: '";
  constexpr std::string_view kNumber = "number overflow parsing '";
  constexpr std::size_t kMax = 60;
  const std::size_t prefix = message.find("] ");
  std::string text = plain_ascii(prefix == std::string::npos ? message : message.substr(prefix + 2));
  if (text.starts_with(kNumber))
    return std::string(kNumber) + abbreviated(text.substr(kNumber.size(), text.size() - kNumber.size() - 1)) +
           "'";
  const std::size_t quote = text.find(kQuote);
  if (quote == std::string::npos) return text;
  const std::size_t begin = quote + kQuote.size();
  const std::size_t end = std::min(text.rfind("'; expected "), text.size() - 1);
  if (end > begin + kMax) text.replace(begin, end - begin - (kMax - 3), "...");
  return text;
}

/// The parser takes a NUL byte for the end of the text. Columns are bytes, from 1; a byte order mark has
/// none.
void reject_nul(std::string_view text, const std::string& name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  const std::size_t nul = text.find('\0');
  if (nul == std::string_view::npos) return;
  const std::string_view before = text.substr(0, nul);
  const auto line = 1 + std::ranges::count(before, '\n');
  const std::size_t column = nul - (before.rfind('\n') + 1);  // npos + 1 is 0
  throw UsageError(name + ": not valid JSON: a NUL byte at line " + std::to_string(line) + ", column " +
                   std::to_string(column + 1));
}

Json parse(const std::string& text, const std::string& name) {
  reject_nul(text, name);
  try {
    StrictnessCheck check(name);
    Json::sax_parse(text, &check, nlohmann::detail::input_format_t::json, true, true);
    return Json::parse(text, nullptr, true, true);  // with comments
  } catch (const Json::exception& error) {
    throw UsageError(name + ": not valid JSON: " + plain_message(error.what()));
  }
}

Json& element(Json& array, const std::string& key, const std::string& assignment) {
  const auto index = exact_number<std::size_t>(key);
  if (!index || *index >= array.size())
    throw UsageError("--set " + abbreviated(assignment) + ": '" + abbreviated(key) +
                     "' is not an index of an array of " + std::to_string(array.size()));
  return array[*index];
}

/// The container that a value becomes that nothing has set yet, so that `key` exists below it: an array where
/// the key is an index and the default is an array.
Json container_for(const std::string& key, const Json& root, const std::string& pointer,
                   const DefaultAt& default_at) {
  if (default_at && is_index(key))
    if (Json array = default_at(root, pointer); array.is_array()) return array;
  return Json::object();
}

void assign(Json& root, const std::string& assignment, const DefaultAt& default_at) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError("--set " + abbreviated(assignment) + ": expected KEY=JSON");
  const std::string text = assignment.substr(equals + 1);
  // A word is a string; the schema then decides whether the key takes one.
  const bool is_word = !Json::accept(text, true) && !text.empty() && text.find_first_of("{[\"") != 0;
  const Json value = is_word ? Json(text) : parse(text, "--set " + abbreviated(assignment));
  Json* target = &root;
  const std::vector<std::string> keys = split_at(assignment.substr(0, equals), '.');
  if (keys.size() > std::size_t{kMaxLevels})
    throw UsageError("--set: a key of " + std::to_string(keys.size()) + " parts, more than " +
                     std::to_string(kMaxLevels));
  const Json before = default_at ? root : Json();
  std::string pointer;
  for (const std::string& key : keys) {
    if (key.empty()) throw UsageError("--set " + abbreviated(assignment) + ": empty key");
    if (target->is_null()) *target = container_for(key, before, pointer, default_at);
    pointer += "/" + key;
    if (!target->is_structured())
      throw UsageError("--set " + abbreviated(assignment) + ": '" + abbreviated(key) +
                       "' is below a value that is neither an object nor an array");
    target = target->is_array() ? &element(*target, key, assignment) : &(*target)[key];
  }
  *target = value;
}

}  // namespace

JsonSource read_json(const std::string& path) {
  if (path.empty()) return {"config", Json::object()};
  const std::string text = read_text(path);
  JsonSource source = parse_json(text, path == "-" ? "standard input" : path);
  if (path == "-" || !std::filesystem::is_regular_file(status_of(path))) source.streams[path] = text;
  return source;
}

JsonSource parse_json(const std::string& text, const std::string& name) {
  Json value = parse(text, name);
  if (!value.is_object()) throw UsageError(name + ": the configuration must be a JSON object");
  return {name, std::move(value)};
}

void apply_assignments(JsonSource& source, const std::vector<std::string>& assignments,
                       const DefaultAt& default_at) {
  for (const std::string& assignment : assignments) assign(source.value, assignment, default_at);
}

}  // namespace landfall
