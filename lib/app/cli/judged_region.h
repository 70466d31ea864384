// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "app/cli/session.h"
#include "app/runs/region_input.h"

namespace landfall::cli {

/// read_region() of the session's configuration; warns of the assumptions about its file.
[[nodiscard]] std::optional<BinMask> read_judged_region(Session& session, RegionMap map,
                                                        Provenance& provenance);

}  // namespace landfall::cli
