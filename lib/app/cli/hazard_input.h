// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "app/cli/tool.h"
#include "store/files/hazard_file.h"
#include "store/files/meeting.h"

namespace landfall::cli {

/// The files of hazard-map; the terrain may be empty.
struct HazardInputFiles {
  std::string map, terrain;
  MeetingRules rules = {};
};

/// The input of map_hazards(): takes the layers of the source, fills small holes in them, and gives the true
/// ground of filled bins the elevation of the terrain or, without one, the mean of its surroundings. Adds the
/// terrain to the provenance. Throws FormatError, UsageError.
[[nodiscard]] HazardInput complete_hazard_input(Session& session, const HazardInputFiles& files,
                                                HazardSource& source, const HazardParameters& parameters,
                                                Provenance& provenance);

}  // namespace landfall::cli
