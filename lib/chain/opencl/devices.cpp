// SPDX-License-Identifier: GPL-3.0-or-later
// A plugin linked with libOpenCL, loaded like the one for GDAL only if a device is requested: no tool
// starts later or needs another library, and the build does without it where the headers are missing.
// Kernels are compiled from source by the driver, because compiled ones fit a single device.
#include "chain/opencl/devices.h"

#include <algorithm>
#include <utility>

#include "base/core/error.h"
#include "base/core/plugin_file.h"
#include "base/text/joined.h"

namespace landfall {
namespace {

/// For a driver that compiles kernels.
constexpr std::size_t kHeadroomOfDriver = std::size_t{192} << 20U;

const void* load_object() {
  try {
    return load_plugin({.file = "landfall-opencl.so",
                        .name = "OpenCL",
                        .needed_by = "OpenCL devices need",
                        .symbol = kOpenClPluginSymbol,
                        .headroom = kHeadroomOfDriver,
                        .remedy = "; install ocl-icd-libopencl1 and the OpenCL driver of the device"});
  } catch (const IoError& error) {
    throw DeviceError(error.what());  // an IoError would blame the output of the run
  }
}

}  // namespace

/// The next call repeats a search that failed.
const OpenClPlugin& opencl_plugin() {
  static const OpenClPlugin& found = *static_cast<const OpenClPlugin*>(load_object());
  return found;
}

std::vector<OpenClDevice> opencl_devices() { return opencl_plugin().devices(); }

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

}  // namespace landfall
