// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "chain/opencl/devices.h"

namespace landfall {

/// Why tests of the engine opencl must be skipped; empty where there is a device. pocl-opencl-icd provides
/// one on every machine.
inline const std::string& no_opencl() {
  static const std::string reason = [] {
    try {
      static_cast<void>(default_device(opencl_devices()));
      return std::string();
    } catch (const DeviceError& error) {
      return std::string(error.what());
    }
  }();
  return reason;
}

}  // namespace landfall
