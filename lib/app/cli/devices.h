// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace landfall::cli {

/// The OpenCL devices under the key `devices`, in the order of the OpenCL library. Throws DeviceError without
/// the library or a device.
[[nodiscard]] nlohmann::ordered_json device_list();

/// The same as a text for people.
[[nodiscard]] std::string devices_text(const nlohmann::ordered_json& list);

}  // namespace landfall::cli
