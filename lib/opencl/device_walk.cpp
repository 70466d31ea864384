// SPDX-License-Identifier: GPL-3.0-or-later
// The plugin: a heightfield in the memory of an OpenCL device, and the rays that walk over it there.
#include <algorithm>
#include <cstring>
#include <mutex>

#include "opencl/cl_device.h"
#include "opencl/plugin.h"

namespace landfall {
namespace {

/// Rays travel as six doubles each.
static_assert(sizeof(Ray) == 6 * sizeof(double));

/// The most rays of one launch: 14 MiB of rays and ranges for each thread that traces, here and on the
/// device.
constexpr std::size_t kMaxRays = std::size_t{1} << 18U;
constexpr std::size_t kGroup = 64;  ///< work-items of a group

/// The buffers and the queue of one call at a time.
struct Stream {
  cl::CommandQueue queue;
  cl::Kernel kernel;  ///< its own, because the arguments of a kernel are not safe to set from two threads
  cl::Buffer rays, ranges;
  cl::Buffer staging;  ///< mapped memory that the bus reads and writes without a copy by the driver
  double* staged = nullptr;
  std::size_t capacity = 0;  ///< rays
};

/// A ray and its range take as many doubles in the staging memory.
constexpr std::size_t kStagedDoubles = sizeof(Ray) / sizeof(double) + 1;

class ClWalk final : public DeviceWalk {
 public:
  ClWalk(const DeviceField& field, const cl::Device& device, OpenClDevice description)
      : description_(std::move(description)),
        device_(device),
        context_(device),
        program_(compiled(context_, device, KernelFile::walk)) {
    const cl::CommandQueue queue(context_, device_);
    ground_ = copied(queue, std::span(&field.ground, 1));
    bounds_ = copied(queue, field.bounds);
    nodes_ = copied(queue, field.nodes);
    queue.finish();
  }

  [[nodiscard]] const OpenClDevice& device() const override { return description_; }

  void walk(std::span<const Ray> rays, std::span<double> ranges) const override {
    on_device(description_.name, "trace rays", [&] {
      Stream stream = take_stream();
      const FinishesQueue finishes(stream.queue);
      for (std::size_t begin = 0; begin < rays.size(); begin += kMaxRays) {
        const std::size_t count = std::min(kMaxRays, rays.size() - begin);
        launch(stream, rays.subspan(begin, count), ranges.subspan(begin, count));
      }
      give_back(std::move(stream));
    });
  }

 private:
  template <class T>
  [[nodiscard]] cl::Buffer copied(const cl::CommandQueue& queue, std::span<const T> values) const {
    cl::Buffer buffer(context_, CL_MEM_READ_ONLY, values.size_bytes());
    queue.enqueueWriteBuffer(buffer, CL_TRUE, 0, values.size_bytes(), values.data());
    return buffer;
  }

  /// A stream that fails is not given back.
  [[nodiscard]] Stream take_stream() const {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        Stream stream = std::move(free_.back());
        free_.pop_back();
        return stream;
      }
    }
    Stream stream;
    stream.queue = cl::CommandQueue(context_, device_);
    stream.kernel = cl::Kernel(program_, "walk");
    stream.kernel.setArg(0, ground_);
    stream.kernel.setArg(1, bounds_);
    stream.kernel.setArg(2, nodes_);
    return stream;
  }

  void give_back(Stream stream) const {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(stream));
  }

  void make_room(Stream& stream, std::size_t rays) const {
    if (rays <= stream.capacity) return;
    const std::size_t staged_bytes = kStagedDoubles * sizeof(double) * rays;
    stream.rays = cl::Buffer(context_, CL_MEM_READ_ONLY, rays * sizeof(Ray));
    stream.ranges = cl::Buffer(context_, CL_MEM_WRITE_ONLY, rays * sizeof(double));
    stream.staging = cl::Buffer(context_, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, staged_bytes);
    stream.staged = static_cast<double*>(
        stream.queue.enqueueMapBuffer(stream.staging, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, staged_bytes));
    stream.capacity = rays;
    stream.kernel.setArg(3, stream.rays);
    stream.kernel.setArg(4, stream.ranges);
  }

  void launch(Stream& stream, std::span<const Ray> rays, std::span<double> ranges) const {
    make_room(stream, rays.size());
    double* const staged_ranges = stream.staged;
    double* const staged_rays = staged_ranges + ranges.size();
    std::memcpy(staged_rays, rays.data(), rays.size_bytes());
    stream.kernel.setArg(5, cl_ulong{rays.size()});
    stream.queue.enqueueWriteBuffer(stream.rays, CL_FALSE, 0, rays.size_bytes(), staged_rays);
    const std::size_t items = (rays.size() + kGroup - 1) / kGroup * kGroup;
    stream.queue.enqueueNDRangeKernel(stream.kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(kGroup));
    stream.queue.enqueueReadBuffer(stream.ranges, CL_TRUE, 0, ranges.size_bytes(), staged_ranges);
    std::memcpy(ranges.data(), staged_ranges, ranges.size_bytes());
  }

  OpenClDevice description_;
  cl::Device device_;
  cl::Context context_;
  cl::Program program_;
  cl::Buffer ground_, bounds_, nodes_;
  mutable std::mutex mutex_;
  mutable std::vector<Stream> free_;
};

std::vector<OpenClDevice> devices() { return described_devices(); }

std::unique_ptr<DeviceWalk> load(const DeviceField& field, std::size_t number) {
  const OpenClDevice& description = described_devices().at(number);
  return on_device(description.name, "load the terrain", [&]() -> std::unique_ptr<DeviceWalk> {
    return std::make_unique<ClWalk>(field, all_devices().at(number), description);
  });
}

}  // namespace
}  // namespace landfall

extern "C" const landfall::OpenClPlugin landfall_opencl_plugin;
const landfall::OpenClPlugin landfall_opencl_plugin{LANDFALL_VERSION, landfall::devices, landfall::load};
