// SPDX-License-Identifier: GPL-3.0-or-later
// Included by the plugin only.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "chain/opencl/cl_device.h"

namespace landfall {

/// The memory of a device, and kernels that it runs one after the other.
class ClWork {
 public:
  explicit ClWork(const cl::Device& device) : device_(device), context_(device), queue_(context_, device) {}

  [[nodiscard]] cl::Program program(KernelFile file) const { return compiled(context_, device_, file); }
  [[nodiscard]] const cl::CommandQueue& queue() const { return queue_; }

  [[nodiscard]] cl::Buffer buffer(std::size_t bytes) const {
    return {context_, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 1)};
  }
  template <class T>
  void write(const cl::Buffer& to, std::span<const T> values) const {
    if (!values.empty()) queue_.enqueueWriteBuffer(to, CL_TRUE, 0, values.size_bytes(), values.data());
  }
  template <class T>
  [[nodiscard]] cl::Buffer copied(std::span<const T> values) const {
    cl::Buffer to = buffer(values.size_bytes());
    write(to, values);
    return to;
  }
  /// After all kernels so far; from value number `first` on.
  template <class T>
  void read(const cl::Buffer& from, std::span<T> values, std::size_t first = 0) const {
    if (!values.empty())
      queue_.enqueueReadBuffer(from, CL_TRUE, first * sizeof(T), values.size_bytes(), values.data());
  }

  /// At least `count` items.
  template <class... Arguments>
  void launch(cl::Kernel& kernel, std::size_t count, const Arguments&... arguments) const {
    constexpr std::size_t kGroup = 64;
    cl_uint number = 0;
    (kernel.setArg(number++, arguments), ...);
    const std::size_t items = (count + kGroup - 1) / kGroup * kGroup;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(kGroup));
  }

 private:
  cl::Device device_;
  cl::Context context_;
  cl::CommandQueue queue_;
};

}  // namespace landfall
