// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/config/chain_config.h"

#include <map>

#include "store/config/dem_config.h"
#include "store/config/hazard_config.h"
#include "store/config/resolved_config.h"
#include "store/config/scan_config.h"
#include "store/config/stage_sections.h"
#include "store/config/terrain_config.h"

namespace landfall {
namespace {

void check_section(const std::string& stage, const nlohmann::json& resolved, const std::string& name) {
  if (stage == "terrain") static_cast<void>(terrain_config(resolved, name));
  if (stage == "scan") static_cast<void>(scan_model(resolved, name, {}));
  if (stage == "regrid") static_cast<void>(regrid_config(resolved, name));
  if (stage == "eval") static_cast<void>(evaluation_config(resolved, name));
  if (stage == "hazard") static_cast<void>(hazard_config(resolved, name));
}

}  // namespace

void check_chain_config(const nlohmann::json& resolved, const std::string& name) {
  std::map<std::string, nlohmann::json> sections;
  for (const std::string& stage : stage_sections("chain")) {
    if (resolved.at(stage).is_null()) continue;
    const JsonSource source = stage_source(stage, resolved.at(stage), name);
    sections[stage] = resolved_config(source, stage);
    check_section(stage, sections[stage], source.name);
  }
  if (sections.contains("hazard")) check_hazard_map(sections["hazard"], sections["regrid"], name);
}

}  // namespace landfall
