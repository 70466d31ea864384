// SPDX-License-Identifier: GPL-3.0-or-later
// Included by the plugin only: the OpenCL library in C++, with errors as exceptions.
#pragma once

#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#include <CL/opencl.hpp>
#include <string>
#include <utility>
#include <vector>

#include "chain/opencl/plugin.h"

namespace landfall {

/// "out of memory" or "CL_INVALID_VALUE"; a number for codes that only a vendor knows.
[[nodiscard]] std::string reason_of(cl_int code);

/// Runs `work`. An error of OpenCL in it becomes a DeviceError, "the OpenCL device NAME failed to TASK
/// (REASON)"; a DeviceError in it, "cannot compile", gets the device's name.
template <class Work>
auto on_device(const std::string& name, const char* task, const Work& work) {
  const std::string device = "the OpenCL device " + name + " ";
  try {
    return work();
  } catch (const cl::Error& error) {
    throw DeviceError(device + "failed to " + task + " (" + reason_of(error.err()) + ")");
  } catch (const DeviceError& error) {
    throw DeviceError(device + error.what());
  }
}

/// Waits at the end of its scope for the work of a queue, also after an error: it may be using the memory
/// of the caller, and drivers crash when a program ends meanwhile.
class FinishesQueue {
 public:
  explicit FinishesQueue(const cl::CommandQueue& queue) : queue_(queue) {}
  FinishesQueue(const FinishesQueue&) = delete;
  FinishesQueue& operator=(const FinishesQueue&) = delete;
  ~FinishesQueue() {
    try {
      queue_.finish();
    } catch (const cl::Error&) {  // of work whose error is reported already
    }
  }

 private:
  cl::CommandQueue queue_;
};

/// All devices of all platforms, in the order of the OpenCL library; none without a driver.
[[nodiscard]] std::vector<cl::Device> all_devices();
/// Also checks its arithmetic, if it has doubles.
[[nodiscard]] OpenClDevice described(const cl::Device& device);

/// The descriptions of all_devices(). Compiles and checks only once, because the devices of a process do not
/// change.
[[nodiscard]] const std::vector<OpenClDevice>& described_devices();

/// In the order of embedded::kKernels.
enum class KernelFile { scene, draws, verdict };

/// The kernels of a file for a device, behind scene.cl for draws and verdicts. Throws cl::Error; DeviceError,
/// without the device's name, with the compiler's message.
[[nodiscard]] cl::Program compiled(const cl::Context& context, const cl::Device& device, KernelFile file);

}  // namespace landfall
