// SPDX-License-Identifier: GPL-3.0-or-later
// Part of the plugin: a scan in the memory of an OpenCL device, and the errors that are drawn there.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "chain/opencl/cl_verdict.h"
#include "chain/opencl/cl_work.h"
#include "chain/opencl/device_draws.h"

namespace landfall {
namespace {

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
        rows_(static_cast<std::size_t>(scene.rows)),
        cols_(static_cast<std::size_t>(scene.cols)),
        bins_(rows_ * cols_),
        work_(device),
        program_(work_.program(KernelFile::draws)),
        clear_(program_, "clear"),
        place_(program_, "place"),
        allot_(program_, "allot"),
        scatter_(program_, "scatter"),
        add_(program_, "add"),
        values_(program_, "values") {
    scene_ = work_.copied(std::span(&scene, 1));
    truth_ = work_.copied(truth);
    estimated_ = work_.buffer(truth.size_bytes());
    errors_ = work_.buffer(sizeof(DeviceErrors));
    dead_ = work_.buffer(pixels_);
    sums_ = work_.buffer(kBinSumBytes * bins_);
    counts_ = work_.buffer(sizeof(cl_uint) * bins_);
    begins_ = work_.buffer(sizeof(cl_uint) * bins_);
    ends_ = work_.buffer(sizeof(cl_uint) * bins_);
    listed_ = work_.buffer(sizeof(cl_uint));
    layers_ = work_.buffer(sizeof(double) * DeviceBins::kLayers * bins_);
  }

  [[nodiscard]] const OpenClDevice& device() const override { return description_; }

  void add_pulses(std::span<const DeviceBeam> beams) override {
    on_device(description_.name, "load the scan", [&] {
      const std::size_t first =
          chunks_.empty() ? 0 : chunks_.back().first_pulse + chunks_.back().count / pixels_;
      chunks_.push_back({work_.copied(beams), beams.size(), first});
    });
  }

  void clear_pulses() override { chunks_.clear(); }

  void draw(const DeviceErrors& errors, std::span<const DevicePose> estimated,
            std::span<const std::int8_t> dead) override {
    on_device(description_.name, "draw errors", [&] {
      const FinishesQueue finishes(work_.queue());
      make_room(errors.weights == DeviceWeights::four ? 4 : 1);
      work_.write(errors_, std::span(&errors, 1));
      work_.write(estimated_, estimated);
      work_.write(dead_, dead);
      work_.launch(clear_, bins_, sums_, counts_, listed_, cl_uint(bins_));
      for (const Chunk& chunk : chunks_) add(chunk);
      work_.launch(values_, bins_, sums_, layers_, counts_, cl_uint(bins_));
    });
  }

  void read(const DeviceBins& bins) override {
    on_device(description_.name, "draw errors", [&] {
      work_.read(layers_, bins.layers);
      work_.read(counts_, bins.counts);
    });
  }

  void prepare_verdicts(const DeviceJudged& judged) override {
    on_device(description_.name, "judge a draw", [&] { verdict_.emplace(work_, rows_, cols_, judged); });
  }

  [[nodiscard]] bool judge(const DeviceRule& rule, std::span<const std::int64_t> half_widths,
                           DeviceVerdict& verdict) override {
    return on_device(description_.name, "judge a draw", [&] {
      const FinishesQueue finishes(work_.queue());
      return verdict_->judge({scene_, layers_, counts_}, rule, half_widths, verdict);
    });
  }

  void take_sums(const DeviceSums& out) override {
    on_device(description_.name, "give the sums of its draws", [&] { verdict_->take_sums(out); });
  }

 private:
  /// Memory for the points of the largest chunk, each listed up to `bins_of_point` times.
  void make_room(std::size_t bins_of_point) {
    std::size_t maximum = 0;
    for (const Chunk& chunk : chunks_) maximum = std::max(maximum, chunk.count);
    if (points_room_ < maximum) {
      points_ = work_.buffer(kPointBytes * maximum);
      points_room_ = maximum;
    }
    if (list_room_ < bins_of_point * maximum) {
      list_ = work_.buffer(sizeof(cl_uint) * bins_of_point * maximum);
      list_room_ = bins_of_point * maximum;
    }
  }

  void add(const Chunk& chunk) {
    const auto count = static_cast<cl_uint>(chunk.count);
    const auto bins = static_cast<cl_uint>(bins_);
    work_.launch(place_, chunk.count, scene_, errors_, chunk.beams, truth_, estimated_, dead_, points_,
                 counts_, cl_ulong{chunk.first_pulse}, count);
    work_.launch(allot_, bins_, counts_, begins_, ends_, listed_, bins);
    work_.launch(scatter_, chunk.count, scene_, errors_, points_, ends_, list_, count);
    work_.launch(add_, bins_, scene_, errors_, points_, begins_, ends_, list_, sums_, listed_, bins);
  }

  OpenClDevice description_;
  std::size_t pixels_, rows_, cols_, bins_;
  ClWork work_;
  cl::Program program_;
  cl::Kernel clear_, place_, allot_, scatter_, add_, values_;
  cl::Buffer scene_, truth_, estimated_, errors_, dead_;
  cl::Buffer sums_, counts_, begins_, ends_, listed_, layers_;
  cl::Buffer points_, list_;
  std::size_t points_room_ = 0, list_room_ = 0;
  std::vector<Chunk> chunks_;
  std::optional<ClVerdict> verdict_;
};

std::vector<OpenClDevice> devices() { return described_devices(); }

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

extern "C" const landfall::OpenClPlugin landfall_opencl_plugin;
const landfall::OpenClPlugin landfall_opencl_plugin{LANDFALL_VERSION, landfall::devices, landfall::load};
