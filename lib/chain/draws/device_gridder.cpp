// SPDX-License-Identifier: GPL-3.0-or-later
// A device draws, bins and judges. A draw on a device has the bits of the CPU's: Philox is integer
// arithmetic, and the normal deviates of D13 are polynomials of operations that OpenCL rounds correctly
// without contraction, so that nothing has to come from the CPU but the pose of each pulse and the dead
// pixels. Elevations of the ground, means of footprints in the order of the exact means of
// lib/chain/evaluation/judge/window_judge.h and quantiles are sums, products and comparisons as well. `hypot`
// is not rounded alike everywhere: where the absolute error is within 10^-12 of its limit, relative, the CPU
// judges the draw, as it does where errors are infinite or too large for the maps. Holes are few: the CPU
// finds them in one byte per bin.
//
// The order in which the CPU adds three products is found, not assumed. On x86-64 Eigen adds those of the
// first two rows of a rotation from the left and those of the third from the right; with other vectors it
// does otherwise. The host computes sums that distinguish the orders and passes the order to the kernels;
// fused products are refused. The results of the CPU stay what they were.
//
// A draw that a device cannot make is refused before the first draw, for each draw of the run, since a
// varied key may ask for it only in the last one. With `opencl-or-cpu` the CPU makes only those draws.
// After a failure of the device it makes all that are left, and begins again the one in progress.
//
// The sums of the maps stay on the device until the state of the run of draws is kept (30 s, or its end),
// because they have 84 bytes per bin and change with each draw. They are integers, so that adding them
// later changes nothing. If the device is lost, the CPU draws again those that it had: rows and verdicts
// are kept already, and the same draw has the same bits.
#include "chain/draws/device_gridder.h"

#include <algorithm>
#include <limits>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "chain/lidar/simulation/beam_points.h"

namespace landfall {
namespace {

constexpr std::int64_t kChunkBeams = std::int64_t{1} << 20U;
constexpr std::size_t kPulsesPerPiece = 64;

DevicePose device_pose(const Transform<DemFrame, LidarFrame>& pose) {
  DevicePose out{};
  for (std::size_t i = 0; i < 9; ++i)
    out.rotation[i] = pose.rotation.m(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
  std::ranges::copy(pose.position.v, out.position.begin());
  return out;
}

std::optional<DeviceWeights> weights_of(Method method) {
  if (method == Method::bilinear_nearest) return DeviceWeights::bilinear;
  if (method == Method::mean) return DeviceWeights::equal;
  if (method == Method::bilinear4) return DeviceWeights::four;
  return std::nullopt;
}

/// DeviceErrors::left_rows of this program.
std::int64_t left_rows() {
  const std::optional<std::int64_t> rows = rows_added_from_left();
  if (!rows)
    throw DeviceError(
        "OpenCL: the CPU adds the products of a rotation in an order that the kernels do not know");
  return *rows;
}

DeviceErrors device_errors(const RangeErrors& errors, DeviceWeights weights) {
  const RangeErrorParameters& p = errors.parameters();
  return {.seed = errors.seed().seed,
          .draw = errors.seed().draw,
          .noise_stream = static_cast<std::uint64_t>(RandomStream::range_noise),
          .dropout_stream = static_cast<std::uint64_t>(RandomStream::dropout),
          .false_stream = static_cast<std::uint64_t>(RandomStream::false_return),
          .sigma_m = p.range_sigma_m,
          .sigma_per_m = p.range_sigma_per_m,
          .spread_rad = p.incidence_sigma_rad,
          .bias_m = p.range_bias_m,
          .dropout = p.dropout_frac,
          .false_frac = p.false_return_frac,
          .false_min_m = p.false_min_m,
          .false_span_m = p.false_max_m - p.false_min_m,
          .is_noisy = errors.is_noisy() ? 1 : 0,
          .has_constant_sigma = errors.has_varying_sigma() ? 0 : 1,
          .weights = weights,
          .left_rows = left_rows()};
}

void take_beams(const PulseWorkspace& w, std::span<DeviceBeam> out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    const Beam& beam = w.aimed.beams[i];
    const bool may_return = !w.aimed.state.blanked && !beam.lost;
    out[i].range_m = may_return ? w.received.ranges_m[i] : -std::numeric_limits<double>::infinity();
    out[i].tan_incidence = w.measured.tan_incidences.empty() ? 0 : w.measured.tan_incidences[i];
    std::ranges::copy(beam.direction.v, out[i].direction.begin());
    std::ranges::copy(beam.exit.v, out[i].exit.begin());
  }
}

}  // namespace

DeviceGridder::DeviceGridder(const TrueRanges& truth, const GridSpec& grid, const OpenClOptions& options)
    : truth_(truth),
      grid_(grid),
      on_failure_(options.on_failure),
      use_(options.use ? options.use : std::make_shared<DeviceUse>()) {
  static_cast<void>(use_->attempt(on_failure_, [&] {
    static_cast<void>(left_rows());
    device_ = usable_device(options.device);
    use_->name_device(opencl_devices()[*device_].name);
  }));
}

std::optional<DeviceRefusal> DeviceGridder::refusal(const Simulation& simulation, Method method) const {
  const Lidar& lidar = simulation.lidar();
  if (!weights_of(method))
    return DeviceRefusal{"regrid/method", "a device bins by bilinear_nearest, bilinear4 or mean"};
  if (lidar.receiver.uses_waveforms())
    return DeviceRefusal{"scan/receiver/type", "a device computes no waveforms"};
  if (lidar.range_timer.is_on())
    return DeviceRefusal{"scan/receiver", "a device draws no jitter, offsets, scale or steps of the timer"};
  if (!lidar.scanner->is_known() || lidar.pointing_error.mirror_time_error_s(0) != 0)
    return DeviceRefusal{"scan/scanner", "a device needs a mechanism whose state the lander knows"};
  return std::nullopt;
}

std::string DeviceGridder::text_of(const DeviceRefusal& refusal) const {
  return std::string("/") + refusal.key + ": " + refusal.reason;
}

void DeviceGridder::check(const Simulation& simulation, Method method) const {
  const auto refused = refusal(simulation, method);
  if (refused && on_failure_ == DeviceFailure::throws)
    throw UsageError(text_of(*refused) + kCpuInstead, "engine");
}

bool DeviceGridder::draw(const Simulation& simulation, Method method) {
  return make(simulation, method, [&](DeviceDraws& draws) {
    layers_.resize(DeviceBins::kLayers * grid_.size());
    counts_.resize(grid_.size());
    draws.read({layers_, counts_});
    return true;
  });
}

bool DeviceGridder::make(const Simulation& simulation, Method method,
                         const std::function<bool(DeviceDraws&)>& finish) {
  if (!device_) return false;
  check(simulation, method);
  if (const auto refused = refusal(simulation, method)) {
    use_->fell_back(text_of(*refused));
    return false;
  }
  bool is_made = false;
  const auto work = [&] {
    const RangeErrors& errors = simulation.lidar().range_errors;
    if (!draws_ || (errors.needs_incidence() && !knows_incidences_)) load(simulation);
    draws_->draw(device_errors(errors, *weights_of(method)), estimated_poses(simulation),
                 simulation.dead_map());
    is_made = finish(*draws_);
  };
  if (!use_->attempt(on_failure_, work)) {
    forget_device();
    return false;
  }
  if (is_made) use_->count_draw();
  return is_made;
}

bool DeviceGridder::attempt(const std::function<void(DeviceDraws&)>& work) {
  if (!draws_) return false;
  const bool is_done = use_->attempt(on_failure_, [&] { work(*draws_); });
  if (!is_done) forget_device();
  return is_done;
}

void DeviceGridder::forget_device() {
  device_.reset();
  draws_.reset();
}

std::vector<DevicePose> DeviceGridder::estimated_poses(const Simulation& simulation) const {
  std::vector<DevicePose> poses(static_cast<std::size_t>(simulation.pulse_count()));
  parallel_for(poses.size(), kPulsesPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      poses[k] = device_pose(simulation.estimated_lidar(static_cast<std::int64_t>(k)));
  });
  return poses;
}

void DeviceGridder::load(const Simulation& simulation) {
  const auto pixels = static_cast<std::int64_t>(simulation.pixel_count());
  if (static_cast<std::int64_t>(truth_.ranges_m.size()) != pixels * simulation.pulse_count())
    throw FormatError("replay: " + std::to_string(truth_.ranges_m.size()) + " ranges where " +
                      std::to_string(pixels * simulation.pulse_count()) + " are needed");
  if (draws_)
    draws_->clear_pulses();  // their incidences are missing
  else
    draws_ = empty_scan(simulation);
  const std::int64_t per_chunk = std::max<std::int64_t>(1, kChunkBeams / pixels);
  for (std::int64_t first = 0; first < simulation.pulse_count(); first += per_chunk)
    load_pulses(simulation, {first, std::min(per_chunk, simulation.pulse_count() - first)});
  knows_incidences_ = simulation.lidar().range_errors.needs_incidence();
}

std::unique_ptr<DeviceDraws> DeviceGridder::empty_scan(const Simulation& simulation) const {
  std::vector<DevicePose> truth(static_cast<std::size_t>(simulation.pulse_count()));
  parallel_for(truth.size(), kPulsesPerPiece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      truth[k] = device_pose(simulation.true_lidar(static_cast<std::int64_t>(k)));
  });
  return opencl_plugin().load({.resolution_m = grid_.resolution_m,
                               .first_row = static_cast<double>(grid_.first_row),
                               .first_col = static_cast<double>(grid_.first_col),
                               .rows = static_cast<double>(grid_.rows),
                               .cols = static_cast<double>(grid_.cols),
                               .pixels = static_cast<std::int64_t>(simulation.pixel_count())},
                              truth, *device_);
}

void DeviceGridder::load_pulses(const Simulation& simulation, PulseSpan pulses) {
  const std::size_t pixels = simulation.pixel_count();
  std::vector<DeviceBeam> beams(static_cast<std::size_t>(pulses.count) * pixels);
  parallel_for(static_cast<std::size_t>(pulses.count), kPulsesPerPiece,
               [&](std::size_t begin, std::size_t end) {
                 PulseWorkspace workspace;
                 for (std::size_t k = begin; k < end; ++k) {
                   const std::int64_t pulse = pulses.first + static_cast<std::int64_t>(k);
                   simulation.prepare_replay(
                       pulse, truth_.part(static_cast<std::size_t>(pulse) * pixels, pixels), workspace);
                   take_beams(workspace, std::span(beams).subspan(k * pixels, pixels));
                 }
               });
  draws_->add_pulses(beams);
}

void DeviceGridder::values(BinIndex first, std::span<BinValues> out) const {
  const std::size_t bins = grid_.size();
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::size_t bin = grid_.index(first) + i;
    out[i] = empty_bin();
    if (counts_[bin] == 0) continue;
    out[i].count = counts_[bin];
    out[i].z_est = layers_[bin];
    out[i].x_true = layers_[bin + bins];
    out[i].y_true = layers_[bin + 2 * bins];
    out[i].x_offset = layers_[bin + 3 * bins];
    out[i].y_offset = layers_[bin + 4 * bins];
  }
}

}  // namespace landfall
