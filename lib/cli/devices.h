// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/progress.h"

namespace landfall::cli {

/// The OpenCL devices and, for comparison, this CPU: each traces the same rays from 500 m to rough relief of
/// 501 x 501 nodes, and its best of three times counts, transfers included. Keys: `devices`, an array in the
/// order of the OpenCL library, and `cpu`. Throws DeviceError without the OpenCL library or a device, or if a
/// device fails.
[[nodiscard]] nlohmann::ordered_json measure_devices(const ProgressCallback& progress);

/// The same as a text for people.
[[nodiscard]] std::string devices_text(const nlohmann::ordered_json& measured);

}  // namespace landfall::cli
