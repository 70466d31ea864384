// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D8, D9, D88, D376
#include "chain/lidar/simulation/simulation.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/text/number_text.h"
#include "base/text/parameter_check.h"

namespace landfall {

std::int64_t pulse_count(const ScanModel& model) {
  const double rate = model.pulse_rate_hz;
  const double time = model.scan_time_s;
  require_positive({"", "pulse_rate_hz"}, rate);
  require_positive({"", "scan_time_s"}, time);
  // A product such as 100 Hz x 0.29 s is slightly below the whole number that it represents.
  const double pulses = std::floor(rate * time + 1e-9);
  require(pulses >= 1 && pulses <= std::numeric_limits<std::int32_t>::max(),
          {"", "pulse_rate_hz x scan_time_s"}, pulses, "in 1..2147483647 pulses");
  const auto count = static_cast<std::int64_t>(pulses);
  if (!model.lidar.pattern) return count;
  return std::min(count, model.lidar.pattern->pulse_limit().value_or(count));
}

namespace {

/// A pose that is not finite would turn all pixels of the pulse into misses.
void require_finite_pose(const Pose& pose, const PulseTime& pulse, const char* which) {
  if (pose.rotation.m.allFinite() && pose.position.v.allFinite()) return;
  throw FormatError("pulse " + std::to_string(pulse.pulse) + ", " + number_text(pulse.since_start_s) +
                    " s after the first: the " + which +
                    " pose is not finite: a value of the trajectory or of an error is too large");
}

}  // namespace

Simulation::Simulation(ScanModel model, const RayEngine* engine, const TerrainSurface* terrain,
                       const SurfaceAlbedo* albedo)
    : pulse_rate_hz_(model.pulse_rate_hz),
      pulse_count_(landfall::pulse_count(model)),
      attitude_knowledge_(model.attitude_knowledge),
      aims_from_estimate_(model.aims_from_estimate),
      first_nominal_pose_(model.trajectory->nominal_pose(0)),
      trajectory_(std::move(model.trajectory)),
      navigation_error_(std::move(model.navigation_error)),
      estimate_(std::move(model.estimate)),
      estimate_lead_s_(estimate_ ? trajectory_->epoch_s() - estimate_->epoch_s() : 0),
      simulator_(std::move(model.lidar), engine, terrain, albedo) {
  // Fail now, not after an hour, if a trajectory or a table of angles is too short.
  const PulseInput last = pulse(pulse_count_ - 1);
  const double mirror_s = simulator_.lidar().pointing_error.mirror_time_error_s(last.time.pulse);
  static_cast<void>(
      simulator_.lidar().scanner->state({.time = {last.time.pulse, last.time.since_start_s + mirror_s}}));
  static_cast<void>(estimated_pose(0));
  static_cast<void>(estimated_pose(since_start_s(pulse_count_ - 1)));
}

Pose Simulation::estimated_pose(double since_start_s) const {
  if (estimate_) return estimate_->pose(since_start_s + estimate_lead_s_);
  Pose known = trajectory_->pose(since_start_s);
  if (attitude_knowledge_ == AttitudeKnowledge::commanded)
    known.rotation = trajectory_->nominal_pose(since_start_s).rotation;
  return navigation_error_ ? navigation_error_->estimated(known, since_start_s) : known;
}

Pose Simulation::aiming_pose(double since_start_s) const {
  if (aims_from_estimate_) return estimated_pose(since_start_s);
  return simulator_.lidar().pattern->compensated() ? trajectory_->nominal_pose(since_start_s)
                                                   : first_nominal_pose_;
}

double Simulation::stamped_time_s(const PulseTime& pulse) const {
  const double error_s = simulator_.lidar().pointing_error.time_stamp_error_s(pulse.pulse);
  if (error_s == 0) return pulse.since_start_s;
  const Trajectory& known = estimate_ ? *estimate_ : *trajectory_;
  return std::clamp(pulse.since_start_s + error_s, known.earliest_time_s() - estimate_lead_s_,
                    known.end_time_s() - estimate_lead_s_);
}

PulseInput Simulation::pulse(std::int64_t k) const {
  const double since_start_s = this->since_start_s(k);
  PulseInput input{.time = {k, since_start_s},
                   .t_s = trajectory_->epoch_s() + since_start_s,
                   .interval_s = 1 / pulse_rate_hz_};
  input.truth = trajectory_->pose(since_start_s);
  input.estimate = estimated_pose(stamped_time_s(input.time));
  if (simulator_.lidar().pattern) input.nominal = aiming_pose(since_start_s);
  require_finite_pose(input.truth, input.time, "true");
  require_finite_pose(input.estimate, input.time, "estimated");
  require_finite_pose(input.nominal, input.time, "nominal");
  return input;
}

void Simulation::simulate(PulseSpan pulses, PulseBatch& batch, bool keep_echoes) const {
  const OptionalColumns columns = this->columns(keep_echoes);
  assert(pulses.first >= 0 && pulses.first + pulses.count <= pulse_count_);
  batch.resize(static_cast<std::size_t>(pulses.count), rows_per_pulse(), PointContent::all, columns);
  simulate_slots(pulses, 0, batch);
  if (columns.return_number) batch.remove_absent_returns();
}

void Simulation::simulate_slots(PulseSpan pulses, std::size_t first_slot, PulseBatch& batch) const {
  PulseWorkspace workspace;
  for (std::size_t i = 0; i < static_cast<std::size_t>(pulses.count); ++i)
    simulator_.simulate(pulse(pulses.first + static_cast<std::int64_t>(i)), first_slot + i, batch, workspace);
}

PulseBatch Simulation::simulate(PulseSpan pulses) const {
  PulseBatch batch;
  simulate(pulses, batch);
  return batch;
}

void Simulation::replay(PulseSpan pulses, const TrueRanges& truth, PulseBatch& batch, PointContent content,
                        bool keep_echoes) const {
  batch.resize(static_cast<std::size_t>(pulses.count), rows_per_pulse(), content, columns(keep_echoes));
  replay_slots(pulses, truth, 0, batch);
}

void Simulation::replay_slots(PulseSpan pulses, const TrueRanges& truth, std::size_t first_slot,
                              PulseBatch& batch) const {
  assert(pulses.first >= 0 && pulses.first + pulses.count <= pulse_count_);
  const std::size_t pixels = pixel_count();
  const auto count = static_cast<std::size_t>(pulses.count);
  const Receiver& receiver = simulator_.lidar().receiver;
  if (!receiver.accepts_kept_echoes())
    throw UsageError(
        "receiver: " + std::string(receiver.type() == ReceiverType::geiger ? "type geiger" : "returns all") +
        " needs the whole waveforms, which no scan keeps; trace the rays");
  const auto require_count = [&](std::size_t given, const char* what) {
    if (given != count * pixels)
      throw FormatError("replay: " + std::to_string(given) + " " + what + " where " +
                        std::to_string(count * pixels) + " are needed");
  };
  require_count(truth.ranges_m.size(), "ranges");
  if (receiver.uses_waveforms()) require_count(truth.echoes.size(), "echoes");
  PulseWorkspace workspace;
  for (std::size_t i = 0; i < count; ++i)
    simulator_.replay(pulse(pulses.first + static_cast<std::int64_t>(i)), truth.part(i * pixels, pixels),
                      first_slot + i, batch, workspace);
}

void Simulation::prepare_replay(std::int64_t pulse, const TrueRanges& truth,
                                PulseWorkspace& workspace) const {
  simulator_.prepare_replay(this->pulse(pulse), truth, workspace);
}

Transform<DemFrame, LidarFrame> Simulation::true_lidar(std::int64_t pulse) const {
  return trajectory_->pose(since_start_s(pulse)) * simulator_.true_mount(pulse);
}

Transform<DemFrame, LidarFrame> Simulation::estimated_lidar(std::int64_t pulse) const {
  const PulseTime time{pulse, since_start_s(pulse)};
  return estimated_pose(stamped_time_s(time)) * simulator_.lidar().mount;
}

Vector<DemFrame> Simulation::position_error(std::int64_t pulse) const {
  const PulseInput input = this->pulse(pulse);
  return input.truth.position - input.estimate.position;
}

}  // namespace landfall
