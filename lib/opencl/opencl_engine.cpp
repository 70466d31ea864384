// SPDX-License-Identifier: GPL-3.0-or-later
// A device decides, it does not approximate. The engine `opencl` has the answers of `heightfield`, bit for
// bit: the range is computed by the same operations in the same order, which OpenCL rounds correctly in
// double precision if contraction is off, and rays that rounding might decide go back to the scalar path
// of lib/ray/packet_walk.h. Single precision would be faster on most devices, and wrong by millimetres at
// 500 m.
//
// Several pulses in a call. A launch costs some ten microseconds, and 324 rays leave a device idle. The
// engine says how many rays it wants (2^17), and the simulation passes that many pulses of a batch in one
// call. Each pulse keeps its memory until then: 0.5 MB with 25 rays per pixel.
//
// A plugin linked with libOpenCL, loaded like the one for GDAL only if the engine is asked for: no tool
// starts later or needs another library, and the build does without it where the headers are missing.
// Kernels are compiled from source by the driver, because compiled ones fit a single device.
#include "opencl/opencl_engine.h"

#include <algorithm>
#include <cassert>
#include <utility>

#include "base/error.h"
#include "base/joined.h"
#include "base/plugin_file.h"
#include "ray/heightfield_engine.h"
#include "ray/packet_walk.h"

namespace landfall {
namespace {

/// For a driver that compiles kernels.
constexpr std::size_t kHeadroomOfDriver = std::size_t{192} << 20U;

/// The next call repeats a search that failed.
const OpenClPlugin& plugin() {
  static const OpenClPlugin& found =
      *static_cast<const OpenClPlugin*>(load_opencl_plugin(kOpenClPluginSymbol));
  return found;
}

/// A launch costs some ten microseconds, and a device has thousands of lanes to fill.
constexpr std::size_t kEfficientRays = std::size_t{1} << 17U;

std::unique_ptr<DeviceWalk> loaded(const Heightfield& field, const OpenClOptions& options) {
  const std::size_t chosen = usable_device(options.device);
  return plugin().load(DeviceField(field), chosen);
}

class OpenClEngine final : public RayEngine {
 public:
  OpenClEngine(std::shared_ptr<const TriangulatedGrid> terrain, const OpenClOptions& options,
               const ProgressCallback& progress)
      : terrain_(std::move(terrain)),
        field_(*terrain_, progress),
        use_(options.use ? options.use : std::make_shared<DeviceUse>()),
        on_failure_(options.on_failure) {
    or_fall_back([&] {
      device_ = loaded(field_, options);
      use_->name_device(device_->device().name);
    });
  }

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    assert(rays.size() == ranges.size());
    const bool asked = !has_failed_ && or_fall_back([&] { device_->walk(rays, ranges); });
    if (!asked) walk_packets(field_, rays, ranges);
    const std::size_t undecided = trace_undecided(field_, rays, ranges);
    if (asked) use_->count(rays.size(), undecided);
  }
  [[nodiscard]] std::size_t efficient_rays() const override { return has_failed_ ? 0 : kEfficientRays; }

 private:
  /// Does work that a device may fail at. Returns false if it did and the CPU takes over.
  template <class Work>
  bool or_fall_back(const Work& work) const {
    if (use_->attempt(on_failure_, work)) return true;
    has_failed_ = true;
    return false;
  }

  std::shared_ptr<const TriangulatedGrid> terrain_;
  Heightfield field_;
  std::shared_ptr<DeviceUse> use_;
  DeviceFailure on_failure_;
  mutable std::atomic<bool> has_failed_ = false;
  std::unique_ptr<const DeviceWalk> device_;
};

}  // namespace

const void* load_opencl_plugin(const char* symbol) {
  try {
    return load_plugin({.file = "landfall-opencl.so",
                        .name = "OpenCL",
                        .needed_by = "OpenCL devices need",
                        .symbol = symbol,
                        .headroom = kHeadroomOfDriver,
                        .remedy = "; install ocl-icd-libopencl1 and the OpenCL driver of the device"});
  } catch (const IoError& error) {
    throw DeviceError(error.what());  // an IoError would blame the output of the run
  }
}

std::vector<OpenClDevice> opencl_devices() { return plugin().devices(); }

std::size_t default_device(const std::vector<OpenClDevice>& devices) {
  for (const char* const kind : {"gpu", "accelerator", ""}) {
    const auto found = std::ranges::find_if(devices, [&](const OpenClDevice& device) {
      return device.is_usable() && (*kind == '\0' || device.kind == kind);
    });
    if (found != devices.end()) return static_cast<std::size_t>(found - devices.begin());
  }
  if (devices.empty()) throw DeviceError("OpenCL: there is no device, or no driver of it is installed");
  const auto reason = [](const OpenClDevice& device) { return device.name + " " + device.problem; };
  throw DeviceError("OpenCL: no device can be used: " + joined(devices, ", and ", reason));
}

std::size_t usable_device(std::optional<std::size_t> chosen) {
  const std::vector<OpenClDevice> devices = opencl_devices();
  const std::size_t number = chosen ? *chosen : default_device(devices);
  if (number >= devices.size()) throw UsageError("there is no OpenCL device " + std::to_string(number));
  if (!devices[number].is_usable())
    throw DeviceError("OpenCL: " + devices[number].name + " " + devices[number].problem);
  return number;
}

void DeviceUse::name_device(const std::string& name) {
  const std::lock_guard lock(mutex_);
  device_ = name;
}

void DeviceUse::fell_back(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = reason;
}

bool DeviceUse::attempt(DeviceFailure on_failure, const std::function<void()>& work) {
  try {
    work();
    return true;
  } catch (const DeviceError& error) {
    if (on_failure == DeviceFailure::throws)
      throw DeviceError(std::string(error.what()) + kCpuInstead, "engine");
    fell_back(error.what());
    return false;
  }
}

std::string DeviceUse::device() const {
  const std::lock_guard lock(mutex_);
  return device_;
}

std::optional<std::string> DeviceUse::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

std::unique_ptr<RayEngine> make_opencl_engine(std::shared_ptr<const TriangulatedGrid> terrain,
                                              const OpenClOptions& options,
                                              const ProgressCallback& progress) {
  return std::make_unique<OpenClEngine>(std::move(terrain), options, progress);
}

}  // namespace landfall
