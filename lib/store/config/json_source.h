// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall {

/// A configuration as the user gave it, before validation.
struct JsonSource {
  std::string name;  ///< for messages: the file's name, "standard input" or "config"
  nlohmann::json value;
  /// Remarks on keys, by their JSON pointers, of objects whose "type" a later one of several merged
  /// configurations has changed: the new type may not know them.
  std::map<std::string, std::string> leftovers = {};
  /// Texts that came from standard input or a pipe, which nobody can read again, by their names on the
  /// command line.
  std::map<std::string, std::string> streams = {};
  std::vector<std::string> imported = {};  ///< keys of a section that an import reads before its validation
};

/// Reads a JSON object. `path` "-" is standard input, "" the empty object. Throws UsageError if the file
/// cannot be read, is not JSON (the message gives line and column; NaN and infinity are not JSON; comments,
/// // and /* */, are allowed), is nested deeper than 64 levels, has a repeated key, or is not an object.
[[nodiscard]] JsonSource read_json(const std::string& path);

/// As read_json(), but from a text; `name` replaces the file name.
[[nodiscard]] JsonSource parse_json(const std::string& text, const std::string& name);

/// The value that a configuration has at a path although nothing sets it: a default. Null if there is none.
using DefaultAt = std::function<nlohmann::json(const nlohmann::json& config, const std::string& pointer)>;

/// Applies `a.b.c=JSON` assignments, UTF-8, in order; a number in the path is an array index, which must
/// exist, in the configuration or in the array that `default_at` gives. Missing objects are created. A text
/// that is not JSON and begins like no JSON container is a string. Throws UsageError naming the assignment if
/// it is not KEY=JSON, has more than 64 keys in its path, or its path leads through a value that is not a
/// container.
void apply_assignments(JsonSource& source, const std::vector<std::string>& assignments,
                       const DefaultAt& default_at = {});

}  // namespace landfall
