// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/resolved_config.h"

#include "config/scan_config.h"
#include "config/schema.h"
#include "config/terrain_config.h"

namespace landfall {

nlohmann::json resolved_config(const JsonSource& source, const std::string& schema) {
  if (schema == "terrain") return resolve_terrain_config(source);
  nlohmann::json config = resolve_config(source, embedded_schema(schema));
  if (schema == "scan") complete_scan_config(config);
  return config;
}

}  // namespace landfall
