// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/core/error.h"

namespace landfall {

/// A compute device is missing, cannot be used or has failed: exit 1.
class DeviceError : public Error {
 public:
  explicit DeviceError(const std::string& message, const char* parameter = "")
      : Error(ExitCode::data_failed, message, parameter) {}
};

/// An OpenCL device, as its driver describes it.
struct OpenClDevice {
  std::string name;
  std::string platform{};
  std::string driver{};  ///< its version
  std::string kind{};    ///< "gpu", "cpu", "accelerator" or "other"
  std::uint64_t memory_bytes = 0;
  bool has_doubles = false;
  /// Why it cannot be used: "has no double precision", "rounds a division otherwise than the CPU", "cannot
  /// compile the kernels (...)"; empty if it can.
  std::string problem{};
  [[nodiscard]] bool is_usable() const { return problem.empty(); }
};

struct DeviceScene;
struct DevicePose;
class DeviceDraws;

/// The functions of the plugin landfall-opencl.so, the only part that is linked with libOpenCL.
struct OpenClPlugin {
  const char* version;
  /// All devices of all platforms, in the order of the OpenCL library; none if no driver is installed.
  std::vector<OpenClDevice> (*devices)();
  /// A scan without beams (chain/opencl/device_draws.h) on the device of the given number among devices(),
  /// which must be usable. `truth`: the true pose of each pulse.
  std::unique_ptr<DeviceDraws> (*load)(const DeviceScene& scene, std::span<const DevicePose> truth,
                                       std::size_t device);
};

/// The name of the plugin's one object, of type OpenClPlugin.
inline constexpr const char* kOpenClPluginSymbol = "landfall_opencl_plugin";

}  // namespace landfall
