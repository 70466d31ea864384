// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "chain/lidar/error_models/navigation_error.h"
#include "chain/lidar/simulation/pulse_simulator.h"
#include "chain/lidar/trajectory/trajectory.h"

namespace landfall {

/// The attitude that the lander starts from, before the navigation error is applied: the true one or, if the
/// lander does not measure it, the nominal one of the trajectory.
enum class AttitudeKnowledge { truth, commanded };

/// A whole scan.
struct ScanModel {
  Lidar lidar;
  std::unique_ptr<const Trajectory> trajectory;
  std::unique_ptr<const NavigationError> navigation_error{};  ///< empty: the estimate equals the truth
  double pulse_rate_hz = 20000;
  double scan_time_s = 2;
  /// The lander's estimated trajectory, on the clock of `trajectory`; used instead of the truth with a
  /// navigation error.
  std::unique_ptr<const Trajectory> estimate{};
  AttitudeKnowledge attitude_knowledge = AttitudeKnowledge::truth;
  /// A compensated pattern aims from the lander's estimated pose at the pulse, without its time-stamp error.
  bool aims_from_estimate = false;
};

/// The number of pulses of a scan. Throws UsageError where pulse_rate_hz or scan_time_s is not finite and
/// positive, or where they give no pulse or 2^31 and more.
[[nodiscard]] std::int64_t pulse_count(const ScanModel& model);

struct PulseSpan {
  std::int64_t first = 0;
  std::int64_t count = 0;
};

/// The pulse loop. Pulses are sent k/f after the trajectory's epoch, k = 0 .. N - 1, N = floor(f T + 1e-9),
/// or fewer if the pattern stops; all pixels of a pulse share its time, pose and scanner state. The pattern
/// aims from the trajectory's nominal pose: at k/f for a compensated pattern, at 0 otherwise; or, if the
/// model says so, from the estimated pose at k/f.
///
/// The estimated pose of the pulse at t is the one at t + e, e the lidar's time-stamp error; t + e is clamped
/// to the times of the trajectory, or of the estimate where one is given.
///
/// Immutable: any number of threads may simulate batches of any size, with identical results.
class Simulation {
 public:
  /// `engine`, `terrain` and `albedo` must outlive this object (see PulseSimulator); a null `engine` allows
  /// replay() only. The model's scanner and trajectory must be set. Throws as pulse_count() does, and
  /// FormatError where the trajectory or a scanner that replays angles ends before the last pulse, or where
  /// an estimate does not cover all pulses.
  Simulation(ScanModel model, const RayEngine* engine, const TerrainSurface* terrain = nullptr,
             const SurfaceAlbedo* albedo = nullptr);

  [[nodiscard]] std::int64_t pulse_count() const { return pulse_count_; }
  /// Whether an engine was given, so that simulate() may be called.
  [[nodiscard]] bool can_trace() const { return simulator_.can_trace(); }
  /// The time of a pulse since the first one.
  [[nodiscard]] double since_start_s(std::int64_t pulse) const {
    return static_cast<double>(pulse) / pulse_rate_hz_;
  }
  /// Number of pulses over pulse rate, seconds.
  [[nodiscard]] double duration_s() const { return static_cast<double>(pulse_count_) / pulse_rate_hz_; }
  /// Rays of all pulses, including those of sub-pixels.
  [[nodiscard]] std::int64_t ray_count() const {
    return pulse_count_ * static_cast<std::int64_t>(simulator_.rays_per_pulse());
  }
  /// The rows of a pulse in a batch that is to be filled (PulseSimulator).
  [[nodiscard]] std::size_t rows_per_pulse() const { return simulator_.rows_per_pulse(); }
  /// The columns of this lidar's points.
  [[nodiscard]] OptionalColumns columns(bool keep_echoes = false) const {
    return simulator_.columns(keep_echoes);
  }
  [[nodiscard]] std::size_t pixel_count() const { return simulator_.lidar().detector.pixel_count(); }
  [[nodiscard]] const Lidar& lidar() const { return simulator_.lidar(); }
  [[nodiscard]] const Detector& detector() const { return simulator_.lidar().detector; }
  /// See PulseSimulator.
  [[nodiscard]] std::span<const std::int8_t> dead_map() const { return simulator_.dead_map(); }

  /// Fills `batch` with all pixels of the pulses, which must lie in 0 .. pulse_count() - 1. Throws
  /// FormatError, naming the pulse, as PulseSimulator does.
  void simulate(PulseSpan pulses, PulseBatch& batch, bool keep_echoes = false) const;
  [[nodiscard]] PulseBatch simulate(PulseSpan pulses) const;
  /// simulate() into the slots from `first_slot` on of a batch that has been resized to rows_per_pulse() and
  /// columns(); rows of returns that do not exist stay. Several threads may fill different slots at the same
  /// time.
  void simulate_slots(PulseSpan pulses, std::size_t first_slot, PulseBatch& batch) const;

  /// simulate() without tracing: the true ranges and, if the receiver sees waveforms, the echoes come from an
  /// earlier run, one per pixel and pulse; only the errors are redrawn. Throws FormatError where their
  /// number does not fit, and UsageError for a receiver that needs whole waveforms.
  void replay(PulseSpan pulses, const TrueRanges& truth, PulseBatch& batch,
              PointContent content = PointContent::all, bool keep_echoes = false) const;
  /// replay() into the slots from `first_slot` on of a batch that has been resized. Several threads may fill
  /// different slots at the same time.
  void replay_slots(PulseSpan pulses, const TrueRanges& truth, std::size_t first_slot,
                    PulseBatch& batch) const;

  /// PulseSimulator::prepare_replay() for a pulse of the scan.
  void prepare_replay(std::int64_t pulse, const TrueRanges& truth, PulseWorkspace& workspace) const;
  /// T_dem_lidar at the pulse, true and estimated.
  [[nodiscard]] Transform<DemFrame, LidarFrame> true_lidar(std::int64_t pulse) const;
  [[nodiscard]] Transform<DemFrame, LidarFrame> estimated_lidar(std::int64_t pulse) const;
  /// The true minus the estimated position of the lander at the pulse, as the pulse table has them.
  [[nodiscard]] Vector<DemFrame> position_error(std::int64_t pulse) const;

 private:
  [[nodiscard]] PulseInput pulse(std::int64_t k) const;
  [[nodiscard]] Pose estimated_pose(double since_start_s) const;
  [[nodiscard]] Pose aiming_pose(double since_start_s) const;
  [[nodiscard]] double stamped_time_s(const PulseTime& pulse) const;

  double pulse_rate_hz_;
  std::int64_t pulse_count_;
  AttitudeKnowledge attitude_knowledge_;
  bool aims_from_estimate_;
  Pose first_nominal_pose_;
  std::unique_ptr<const Trajectory> trajectory_;
  std::unique_ptr<const NavigationError> navigation_error_;
  std::unique_ptr<const Trajectory> estimate_;
  double estimate_lead_s_;  ///< how long after the estimate's epoch that of the trajectory is
  PulseSimulator simulator_;
};

}  // namespace landfall
