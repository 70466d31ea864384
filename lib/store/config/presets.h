// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "store/config/json_source.h"

namespace landfall {

/// A configuration that is part of the program: studies/presets/NAME.SCHEMA.json.
struct Preset {
  std::string name;
  std::string description;  ///< its "$comment": one line
};

/// The presets for a schema (embedded_schema()), by name.
[[nodiscard]] std::vector<Preset> presets(const std::string& schema);

/// Reads the configurations that -c names and merges them in order (RFC 7396: a later value replaces an
/// earlier one, objects are merged, null removes). Each is a file, "-" (standard input) or "preset:NAME".
/// Without any, the configuration is empty. Sections of stages are expanded before they are merged
/// (expand_stage_sections()). Throws UsageError as read_json() does, and for an unknown preset.
[[nodiscard]] JsonSource read_config(const std::vector<std::string>& names, const std::string& schema);

}  // namespace landfall
