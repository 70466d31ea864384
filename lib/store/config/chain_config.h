// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall {

/// Checks the sections of a resolved configuration of `landfall run` as the tools check theirs, and that the
/// map holds and resolves the lander, but for files that they name. Throws UsageError that begins with `name`
/// and the section.
void check_chain_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
