// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/judged_region.h"

namespace landfall::cli {

std::optional<BinMask> read_judged_region(Session& session, const RegionMap& map, Provenance& provenance) {
  const RegionConfig region = region_config(session.config(), session.config_name());
  std::optional<BinMask> mask = read_region(region, map, session.config_name(), provenance);
  if (!mask || region.source->path.empty()) return mask;
  for (const std::string& assumed : provenance.inputs.back().assumed)
    session.warn(region.source->path + ": " + assumed);
  return mask;
}

}  // namespace landfall::cli
