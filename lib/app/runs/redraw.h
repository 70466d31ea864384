// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "store/files/provenance.h"
#include "store/files/range_file.h"

namespace landfall {

/// Refuses to draw the errors of this configuration over what an earlier scan saw, unless a traced scan would
/// see the same: the earlier one was made by this version on the same terrain and tables; no key differs that
/// moves the true beams or, with a receiver, shapes the echoes (KeyEffect); the seed is the same if it moves
/// the beams; and the scan holds the true range of every pixel that hit, in double precision, and the echoes
/// that the receiver accepts. Throws UsageError, naming the key and both values; `option` begins the message.
void require_redraw(const RangeFile& scan, const Provenance& provenance,
                    const std::string& option = "--ranges-from ");

/// True if a scan with these errors has rows for the same pixels and pulses, with the same truth: both scans
/// keep their misses, or neither loses a pixel that hit; and neither has false returns.
[[nodiscard]] bool has_rows_of(const RangeFile& scan, const nlohmann::json& config, bool keep_misses);

}  // namespace landfall
