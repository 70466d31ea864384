// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/chain_config.h"

#include "config/dem_config.h"
#include "config/hazard_config.h"
#include "config/resolved_config.h"
#include "config/scan_config.h"
#include "config/stage_sections.h"
#include "config/terrain_config.h"

namespace landfall {
namespace {

void check_section(const std::string& stage, const JsonSource& section) {
  const nlohmann::json resolved = resolved_config(section, stage);
  if (stage == "terrain") static_cast<void>(terrain_config(resolved, section.name));
  if (stage == "scan") static_cast<void>(scan_model(resolved, section.name, {}));
  if (stage == "regrid") static_cast<void>(regrid_config(resolved, section.name));
  if (stage == "eval") static_cast<void>(evaluation_config(resolved, section.name));
  if (stage == "hazard") static_cast<void>(hazard_config(resolved, section.name));
}

}  // namespace

void check_chain_config(const nlohmann::json& resolved, const std::string& name) {
  for (const std::string& stage : stage_sections()) {
    if (!resolved.at(stage).is_null()) check_section(stage, {name + ": /" + stage, resolved.at(stage)});
  }
}

}  // namespace landfall
