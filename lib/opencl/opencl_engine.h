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

#include "base/progress.h"
#include "opencl/plugin.h"
#include "ray/engine.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {

/// The plugin's object of this name (base/plugin_file.h). Throws DeviceError without the plugin
/// landfall-opencl.so or without libOpenCL.
[[nodiscard]] const void* load_opencl_plugin(const char* symbol);

/// All OpenCL devices. Loads the plugin landfall-opencl.so (base/plugin_file.h); throws DeviceError without
/// it or without libOpenCL.
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

/// Counts the rays of all engines, or the draws of a campaign, that share it.
class DeviceUse {
 public:
  void count(std::size_t rays, std::size_t undecided) {
    rays_ += rays;
    undecided_ += undecided;
  }
  void count_draw() { ++draws_; }
  /// Keeps the first reason, and the device's name if it is known.
  void name_device(const std::string& name);
  void fell_back(const std::string& reason);
  /// Does work that a device may fail at. Returns false, having kept the reason, if it did and the CPU takes
  /// over; throws DeviceError for the option "engine" if that is not wanted.
  [[nodiscard]] bool attempt(DeviceFailure on_failure, const std::function<void()>& work);

  [[nodiscard]] std::uint64_t rays() const { return rays_; }  ///< that a device was asked
  /// Rays among them that the device could not decide: the CPU traced them.
  [[nodiscard]] std::uint64_t undecided() const { return undecided_; }
  [[nodiscard]] std::uint64_t draws() const { return draws_; }  ///< that a device made
  [[nodiscard]] std::string device() const;
  /// Why the CPU did work that a device was to do; nothing unless that happened.
  [[nodiscard]] std::optional<std::string> failure() const;

 private:
  std::atomic<std::uint64_t> rays_ = 0;
  std::atomic<std::uint64_t> undecided_ = 0;
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

/// First hits on a gridded terrain, found by an OpenCL device with double precision: bit for bit the answers
/// of make_heightfield_engine(). The device computes ranges by the same operations in the same order, each
/// rounded as on the CPU, which is checked when it is opened; the CPU traces the rays whose answer rounding
/// might change. The device keeps a copy of the terrain, about 17 bytes per node.
///
/// Throws DeviceError as opencl_devices() and default_device() do, and if the device fails, also from
/// first_hits(). With DeviceFailure::falls_back the CPU traces from then on instead.
[[nodiscard]] std::unique_ptr<RayEngine> make_opencl_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                                            const OpenClOptions& options = {},
                                                            const ProgressCallback& progress = {});

}  // namespace landfall
