// SPDX-License-Identifier: GPL-3.0-or-later
// Schemas have their own versions, in a URN, because landfall owns no domain. A new key is a minor
// version; any change that makes a configuration mean something else is a major one. The key `$schema` is
// removed before anything is hashed or stored.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "store/config/json_source.h"

namespace landfall {

/// The JSON schema (draft-07) of a tool's configuration, embedded from schemas/NAME.schema.json; NAME is
/// terrain, scan, regrid, eval, hazard, draws or chain. Any other throws std::out_of_range.
[[nodiscard]] const nlohmann::json& embedded_schema(const std::string& name);

/// The text of that schema for users and editors; with those of the stages in its sections, where it has such
/// (cmake/composed_schema.py).
[[nodiscard]] std::string printed_schema(const std::string& name);

/// Checks a configuration against a schema and fills in the schema's defaults: the resolved configuration.
///
/// A walk over schema and value together fills in the defaults and reports errors; it knows the keywords of
/// draft-07 that schemas/ uses (tests/unit/store/config/schema_test.cpp), and accepts what python3-jsonschema
/// accepts (tests/cli/schemas_test.py). For an unknown key it names the nearest known one. A `oneOf` is
/// selected by the value's "type" (which defaults to that of the `oneOf` owner's default) or by JSON type.
/// The keys "$schema" and "$comment" at the top are removed. Throws UsageError.
[[nodiscard]] nlohmann::json resolve_config(const JsonSource& source, const nlohmann::json& schema);

/// The definition that a node of a schema refers to by "$ref"; the node itself where it does not.
[[nodiscard]] const nlohmann::json& dereferenced(const nlohmann::json& schema, const nlohmann::json& node);

/// The value at a JSON pointer of the resolved configuration, defaults included; null if there is none, or if
/// the configuration is not valid.
[[nodiscard]] nlohmann::json default_at(const nlohmann::json& config, const nlohmann::json& schema,
                                        const std::string& pointer);

/// The member of `known` that `word` most probably means: the nearest (edit distance <= 2, or one third of
/// the word), else the shortest that contains it ("rocks" in "golombek_rocks"); empty if there is none.
[[nodiscard]] std::string nearest_word(const std::string& word, const std::vector<std::string>& known);

}  // namespace landfall
