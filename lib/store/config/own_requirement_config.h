// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/dictionary/requirement.h"

namespace landfall {

/// The numbers on which requirements can be set: those of a JSON result.
struct ResultFields {
  std::string file;  ///< for messages: "metrics.json"
  std::vector<ResultField> fields;
};

/// The key `requirements` of a resolved configuration; none without it. `where` is the configuration's path
/// for messages: "eval.json: ". Throws UsageError for a metric that is not a number of the result, for a
/// requirement that has both of max and min or neither, and for a name that is not 1 to 40 letters, digits,
/// '_', '-' and spaces, occurs twice, or is that of a requirement that every evaluation has.
[[nodiscard]] std::vector<Requirement> own_requirements(const nlohmann::json& resolved,
                                                        const std::string& where, const ResultFields& result);

}  // namespace landfall
