// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/judged_region.h"

namespace landfall::cli {

std::optional<BinMask> read_judged_region(Session& session, RegionMap map, Provenance& provenance) {
  map.warn = [&](const std::string& text) { session.warn(text); };
  return read_region(region_config(session.config(), session.config_name()), map, session.config_name(),
                     provenance);
}

}  // namespace landfall::cli
