// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "chain/opencl/plugin.h"

namespace landfall {

/// Loads the plugin landfall-opencl.so (base/core/plugin_file.h). Throws DeviceError without it or without
/// libOpenCL.
[[nodiscard]] const OpenClPlugin& opencl_plugin();

/// All OpenCL devices. Throws as opencl_plugin() does.
[[nodiscard]] std::vector<OpenClDevice> opencl_devices();

/// The number of the device that is used unless another one is chosen: the first usable GPU, else
/// accelerator, else any usable device. Throws DeviceError, saying what there is, if none is usable.
[[nodiscard]] std::size_t default_device(const std::vector<OpenClDevice>& devices);

/// The number of the `chosen` device, or of the default_device(). Throws as opencl_devices() and
/// default_device() do, UsageError if there is no device of that number, and DeviceError if it cannot be
/// used.
[[nodiscard]] std::size_t usable_device(std::optional<std::size_t> chosen);

/// The reaction to a device that is missing or fails.
enum class DeviceFailure { throws, falls_back };

/// The end of a message about work that is not done.
inline constexpr const char* kCpuInstead = "; opencl-or-cpu uses the CPU instead";

/// Counts the draws of a run that a device made.
class DeviceUse {
 public:
  void count_draw() { ++draws_; }
  /// Keeps the first reason, and the device's name if it is known.
  void name_device(const std::string& name);
  void fell_back(const std::string& reason);
  /// Does work that a device may fail at. Returns false, having kept the reason, if it did and the CPU takes
  /// over; throws DeviceError for the option "engine" if that is not wanted.
  [[nodiscard]] bool attempt(DeviceFailure on_failure, const std::function<void()>& work);

  [[nodiscard]] std::uint64_t draws() const { return draws_; }  ///< that a device made
  [[nodiscard]] std::string device() const;
  /// Why the CPU did work that a device was to do; nothing unless that happened.
  [[nodiscard]] std::optional<std::string> failure() const;

 private:
  std::atomic<std::uint64_t> draws_ = 0;
  mutable std::mutex mutex_;
  std::string device_;
  std::optional<std::string> failure_;
};

struct OpenClOptions {
  std::optional<std::size_t> device{};  ///< its number among opencl_devices(); the default_device() otherwise
  DeviceFailure on_failure = DeviceFailure::throws;
  std::shared_ptr<DeviceUse> use{};  ///< null: not counted
};

}  // namespace landfall
