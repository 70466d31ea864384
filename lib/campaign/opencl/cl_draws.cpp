// SPDX-License-Identifier: GPL-3.0-or-later
// Of the plugin: a scan in the memory of an OpenCL device, and the errors that are drawn there.
#include <algorithm>
#include <utility>
#include <vector>

#include "campaign/opencl/device_draws.h"
#include "ray/opencl/cl_device.h"

namespace landfall {
namespace {

constexpr std::size_t kGroup = 64;        ///< work-items of a group
constexpr std::size_t kPointBytes = 40;   ///< Point in draws.cl
constexpr std::size_t kBinSumBytes = 64;  ///< Sums in draws.cl

/// Pulses that are processed together.
struct Chunk {
  cl::Buffer beams;
  std::size_t count;  ///< beams
  std::size_t first_pulse;
};

class ClDraws final : public DeviceDraws {
 public:
  ClDraws(const DeviceScene& scene, std::span<const DevicePose> truth, const cl::Device& device,
          OpenClDevice description)
      : description_(std::move(description)),
        pixels_(static_cast<std::size_t>(scene.pixels)),
        pulses_(truth.size()),
        bins_(static_cast<std::size_t>(scene.rows * scene.cols)),
        context_(device),
        queue_(context_, device),
        program_(compiled(context_, device, KernelFile::draws)),
        clear_(program_, "clear"),
        place_(program_, "place"),
        allot_(program_, "allot"),
        scatter_(program_, "scatter"),
        add_(program_, "add"),
        values_(program_, "values") {
    scene_ = copied(std::span(&scene, 1));
    truth_ = copied(truth);
    believed_ = buffer(truth.size_bytes());
    errors_ = buffer(sizeof(DeviceErrors));
    dead_ = buffer(pixels_);
    sums_ = buffer(kBinSumBytes * bins_);
    counts_ = buffer(sizeof(cl_uint) * bins_);
    begins_ = buffer(sizeof(cl_uint) * bins_);
    ends_ = buffer(sizeof(cl_uint) * bins_);
    listed_ = buffer(sizeof(cl_uint));
    layers_ = buffer(sizeof(double) * DeviceBins::kLayers * bins_);
  }

  [[nodiscard]] const OpenClDevice& device() const override { return description_; }

  void add_pulses(std::span<const DeviceBeam> beams) override {
    on_device(description_.name, "load the scan", [&] {
      const std::size_t first =
          chunks_.empty() ? 0 : chunks_.back().first_pulse + chunks_.back().count / pixels_;
      chunks_.push_back({copied(beams), beams.size(), first});
    });
  }

  void draw(const DeviceErrors& errors, std::span<const DevicePose> believed,
            std::span<const std::int8_t> dead, const DeviceBins& bins) override {
    on_device(description_.name, "draw errors", [&] {
      const FinishesQueue finishes(queue_);
      make_room(errors.weights == DeviceWeights::four ? 4 : 1);
      write(errors_, std::span(&errors, 1));
      write(believed_, believed);
      write(dead_, dead);
      launch(clear_, bins_, sums_, counts_, listed_, cl_uint(bins_));
      for (const Chunk& chunk : chunks_) add(chunk);
      launch(values_, bins_, sums_, layers_, counts_, cl_uint(bins_));
      queue_.enqueueReadBuffer(layers_, CL_FALSE, 0, bins.layers.size_bytes(), bins.layers.data());
      queue_.enqueueReadBuffer(counts_, CL_TRUE, 0, bins.counts.size_bytes(), bins.counts.data());
    });
  }

 private:
  [[nodiscard]] cl::Buffer buffer(std::size_t bytes) const {
    return {context_, CL_MEM_READ_WRITE, std::max<std::size_t>(bytes, 1)};
  }
  template <class T>
  void write(const cl::Buffer& to, std::span<const T> values) const {
    queue_.enqueueWriteBuffer(to, CL_TRUE, 0, values.size_bytes(), values.data());
  }
  template <class T>
  [[nodiscard]] cl::Buffer copied(std::span<const T> values) const {
    cl::Buffer to = buffer(values.size_bytes());
    write(to, values);
    return to;
  }

  /// Memory for the points of the largest chunk, each listed up to `bins_of_point` times.
  void make_room(std::size_t bins_of_point) {
    std::size_t most = 0;
    for (const Chunk& chunk : chunks_) most = std::max(most, chunk.count);
    if (points_room_ < most) {
      points_ = buffer(kPointBytes * most);
      points_room_ = most;
    }
    if (list_room_ < bins_of_point * most) {
      list_ = buffer(sizeof(cl_uint) * bins_of_point * most);
      list_room_ = bins_of_point * most;
    }
  }

  void add(const Chunk& chunk) {
    const auto count = static_cast<cl_uint>(chunk.count);
    const auto bins = static_cast<cl_uint>(bins_);
    launch(place_, chunk.count, scene_, errors_, chunk.beams, truth_, believed_, dead_, points_, counts_,
           cl_ulong{chunk.first_pulse}, count);
    launch(allot_, bins_, counts_, begins_, ends_, listed_, bins);
    launch(scatter_, chunk.count, scene_, errors_, points_, ends_, list_, count);
    launch(add_, bins_, scene_, errors_, points_, begins_, ends_, list_, sums_, listed_, bins);
  }

  template <class... Arguments>
  void launch(cl::Kernel& kernel, std::size_t count, const Arguments&... arguments) {
    cl_uint number = 0;
    (kernel.setArg(number++, arguments), ...);
    const std::size_t items = (count + kGroup - 1) / kGroup * kGroup;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(items), cl::NDRange(kGroup));
  }

  OpenClDevice description_;
  std::size_t pixels_, pulses_, bins_;
  cl::Context context_;
  cl::CommandQueue queue_;
  cl::Program program_;
  cl::Kernel clear_, place_, allot_, scatter_, add_, values_;
  cl::Buffer scene_, truth_, believed_, errors_, dead_;
  cl::Buffer sums_, counts_, begins_, ends_, listed_, layers_;
  cl::Buffer points_, list_;
  std::size_t points_room_ = 0, list_room_ = 0;
  std::vector<Chunk> chunks_;
};

std::unique_ptr<DeviceDraws> load(const DeviceScene& scene, std::span<const DevicePose> truth,
                                  std::size_t number) {
  const cl::Device device = all_devices().at(number);
  OpenClDevice description = described_devices().at(number);
  const std::string name = description.name;
  return on_device(name, "load the scan", [&]() -> std::unique_ptr<DeviceDraws> {
    return std::make_unique<ClDraws>(scene, truth, device, std::move(description));
  });
}

}  // namespace
}  // namespace landfall

extern "C" const landfall::OpenClDrawsPlugin landfall_opencl_draws;
const landfall::OpenClDrawsPlugin landfall_opencl_draws{LANDFALL_VERSION, landfall::load};
