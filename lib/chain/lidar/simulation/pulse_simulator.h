// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "base/geometry/rotation.h"
#include "chain/lidar/detector/detector.h"
#include "chain/lidar/error_models/pointing_error.h"
#include "chain/lidar/error_models/range_errors.h"
#include "chain/lidar/receiver/range_timer.h"
#include "chain/lidar/receiver/receiver.h"
#include "chain/lidar/scanner/pattern.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/simulation/pulse_batch.h"
#include "chain/lidar/trajectory/trajectory.h"
#include "chain/ray/engine.h"
#include "chain/terrain/surface.h"

namespace landfall {

/// The instrument: everything about a scan except the lander's motion and the terrain.
struct Lidar {
  Detector detector;
  std::unique_ptr<const Scanner> scanner;
  std::unique_ptr<const Pattern> pattern{};  ///< empty: the scanner gets no aim
  /// T_body_lidar. Nominally +z_L looks down and x_L is x_B: diag(1, -1, -1).
  Transform<BodyFrame, LidarFrame> mount{rotation_from<BodyFrame, LidarFrame>({std::numbers::pi, 0, 0}), {}};
  RangeErrors range_errors;
  PointingError pointing_error{};
  Receiver receiver{};
  RangeTimer range_timer{};
  /// The link constant of each sample of the detector, photoelectrons x m^2: that of a whole pixel
  /// (chain/lidar/receiver/link_budget.h) over the samples per pixel, times the beam's relative irradiance
  /// there and, if the terrain has no map of it, the albedo. Empty unless the receiver sees waveforms.
  std::vector<double> link_constants_pe_m2{};
};

/// One pulse, as the caller that moves the lander defines it.
struct PulseInput {
  PulseTime time{};
  double t_s = 0;         ///< as written to the pulse table
  double interval_s = 0;  ///< to the next pulse; 0: the aim is taken as constant
  Pose truth{};
  Pose estimate{};  ///< the estimated pose
  Pose nominal{};   ///< the pose that the pattern aims from
};

/// The ranges of an earlier run: one range and echo for each pixel.
struct TrueRanges {
  std::span<const double> ranges_m;    ///< NaN for a miss
  std::span<const Echo> echoes{};      ///< empty unless the receiver sees waveforms
  std::span<const LaterEcho> later{};  ///< ordered by pulse, pixel, number; may hold other pulses

  [[nodiscard]] TrueRanges part(std::size_t first, std::size_t count) const {
    return {ranges_m.subspan(first, count), echoes.empty() ? echoes : echoes.subspan(first, count), later};
  }
};

// The phases of a pulse. Each is filled by one step and constant for those that follow, except that the hits
// are used up when they become ranges and waveforms.

/// The beams that leave.
struct AimedPulse {
  ScannerState state;
  std::vector<Beam> beams;            ///< of the pixels
  std::vector<Beam> estimated_beams;  ///< empty where the lander knows the true ones: equal to `beams`
  Transform<DemFrame, LidarFrame> T_dem_lidar;  ///< the true lidar
};

/// The places where its rays meet the ground; unused by a replay.
struct TracedPulse {
  std::vector<Beam> sample_beams;  ///< empty where a pixel has one sample
  std::vector<Ray> rays;           ///< of the beams that are not lost
  std::vector<double> hits_m;      ///< of all beams; NaN for a miss
};

/// The echoes and ranges that come back, before errors.
struct ReceivedPulse {
  std::vector<double> ranges_m;  ///< true ones of the pixels; NaN for a miss
  Waveforms waveforms;
  std::vector<Echo> echoes;  ///< one for each pixel; empty unless the receiver accepts kept echoes
  std::vector<LaterEcho> later_echoes;
  // While waveforms are built, of the samples that hit:
  std::vector<double> signals_pe;  ///< of all samples; NaN for a miss
  std::vector<Eigen::Vector3d> hits;
  std::vector<Eigen::Vector3d> hit_directions;
  std::vector<double> cosines;  ///< of the incidence angles; NaN on the edge of a hole
};

/// The ranges that the instrument reports.
struct MeasuredPulse {
  std::vector<double> tan_incidences;   ///< empty where the noise does not depend on them; 0 for a miss
  std::vector<Detection> detections;    ///< by pixel, then return; empty without a receiver
  std::vector<double> reported_m;       ///< the ranges of one return of each pixel, before range errors
  std::vector<double> measured_m;       ///< by return, then pixel
  std::vector<std::int8_t> is_dropped;  ///< of the pixels
  std::vector<PointStatus> statuses;    ///< of the pixels, without false returns
};

/// Memory that a thread reuses between pulses.
struct PulseWorkspace {
  AimedPulse aimed;
  TracedPulse traced;
  ReceivedPulse received;
  MeasuredPulse measured;
  std::vector<double> row_measured_m;  ///< the measured range of each row; NaN without a return
  std::vector<double> row_shown_m;     ///< the range of each row's true point
};

/// One pulse from poses to points, independent of a Trajectory: a host simulator can step it with its own
/// poses and RayEngine. The result depends on the arguments only: any thread may compute any pulse.
///
/// The true beam leaves from the true pose and mount (PointingError), aimed from the pose `nominal` and the
/// nominal mount: navigation error does not move it unless the caller aims from the estimate.
///
/// A point is s = p + R (p_BL + R_BL (b + r n)) (Eqs. 1 and 7): p, R are the pose, p_BL, R_BL the mount, b, n
/// the beam, r the range. The true point uses the true range, mount and pose; the estimated point uses the
/// measured range, the nominal mount and the estimated pose. Both use the same b and n unless the lander does
/// not know the mechanism's state (Scanner::is_known, PointingError::mirror_time_error_s). With a receiver
/// that sees waveforms, the true range is that of the pixel's own direction, while the receiver sees the
/// echoes of the samples; a pixel whose own direction misses is a miss.
///
/// A pixel's status is the first that applies of dead, blanked, lost in the optics, miss, undetected,
/// dropout. A false return may replace a miss, an undetected echo, a dropout or a return from farther away. A
/// background photoelectron is reported as a false return, too.
///
/// The caller applies time-stamp errors when it chooses the estimated poses.
class PulseSimulator {
 public:
  /// `engine`, `terrain` and `albedo` must outlive this object. Without an engine (null), only replay() may
  /// be called. With a ground, a beam that starts at or below it is refused, if
  /// TerrainSurface::is_terrain_below(). `albedo` is the ground's map of it, in [0, 1]; null:
  /// link_constants_pe_m2 include the albedo. Throws UsageError without a ground if the noise depends on the
  /// incidence or if waveforms are traced.
  PulseSimulator(Lidar lidar, const RayEngine* engine, const TerrainSurface* terrain,
                 const SurfaceAlbedo* albedo = nullptr);

  [[nodiscard]] const Lidar& lidar() const { return lidar_; }
  [[nodiscard]] bool can_trace() const { return engine_ != nullptr; }
  /// 1 for each dead pixel, 0 for the others, row-major.
  [[nodiscard]] std::span<const std::int8_t> dead_map() const { return dead_map_; }
  /// The rows of a pulse in a batch, including those of returns that do not exist
  /// (PulseBatch::kNoSuchReturn).
  [[nodiscard]] std::size_t rows_per_pulse() const {
    return lidar_.detector.pixel_count() * lidar_.receiver.max_returns();
  }
  [[nodiscard]] std::size_t rays_per_pulse() const {
    const Detector& detector = lidar_.detector;
    const bool own_rays = lidar_.receiver.uses_waveforms() && detector.samples_per_pixel() > 1;
    return detector.samples().size() + (own_rays ? detector.pixel_count() : 0);
  }
  /// The columns of this lidar's points.
  [[nodiscard]] OptionalColumns columns(bool keep_echoes = false) const {
    return {.intensity = lidar_.receiver.uses_waveforms(),
            .return_number = lidar_.receiver.max_returns() > 1,
            .echo = keep_echoes,
            .later_echoes = keep_echoes && lidar_.receiver.accepts_later_echoes()};
  }

  /// Fills pulse `slot` of `batch`, which has been resized to rows_per_pulse(); the truth only where
  /// the batch holds it. All rays of the pulse go to the engine in one call, in pixel order and, within a
  /// pixel, in sub-pixel order. Throws FormatError, naming the pulse, where the scanner cannot follow the
  /// aim, or for a beam that starts at or below the ground.
  void simulate(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                PulseWorkspace& workspace) const;

  /// simulate() without tracing: the true ranges come from an earlier run, one per pixel, NaN for a miss, and
  /// so do the echoes if the receiver uses waveforms; it must then accept kept echoes.
  void replay(const PulseInput& pulse, const TrueRanges& truth, std::size_t slot, PulseBatch& batch,
              PulseWorkspace& workspace) const;
  /// The part of replay() before any error is drawn: fills the aimed and the received pulse and, where the
  /// noise depends on them, tan_incidences.
  void prepare_replay(const PulseInput& pulse, const TrueRanges& truth, PulseWorkspace& workspace) const;
  /// T_body_lidar_true at the pulse.
  [[nodiscard]] Transform<BodyFrame, LidarFrame> true_mount(std::int64_t pulse) const;

 private:
  void load_true_ranges(const PulseInput& pulse, const TrueRanges& truth, PulseWorkspace& workspace) const;
  /// The scanner's input at the pulse's time plus an error of the mirror's clock; aims are seen from the
  /// pulse's nominal pose.
  [[nodiscard]] PulseContext context_of(const PulseInput& pulse, double mirror_time_error_s) const;
  void steer(const PulseInput& pulse, AimedPulse& aimed) const;
  /// steer(); if the scanner cannot aim because the lidar is at or below the ground, the error says so.
  void steer_to_trace(const PulseInput& pulse, AimedPulse& aimed) const;
  /// The beams of the pulse's rays, in order: those of the samples, then the pixels' own where they differ.
  [[nodiscard]] std::span<const Beam> traced_beams(const AimedPulse& aimed, const TracedPulse& traced) const;
  void make_rays(const PulseInput& pulse, const AimedPulse& aimed, TracedPulse& traced) const;
  void require_above_terrain(const PulseInput& pulse, const Point<DemFrame>& origin) const;
  void trace(std::span<const Ray> rays, std::vector<double>& hits_m) const;
  /// Uses up the hits: they are sorted in place.
  void combine_samples(std::int64_t pulse, const AimedPulse& aimed, TracedPulse& traced,
                       ReceivedPulse& received) const;
  void build_waveforms(std::int64_t pulse, const AimedPulse& aimed, TracedPulse& traced,
                       ReceivedPulse& received) const;
  void find_signals(const TracedPulse& traced, std::span<const Beam> samples, ReceivedPulse& received) const;
  void find_incidences(const AimedPulse& aimed, const ReceivedPulse& received, MeasuredPulse& measured) const;
  void receive(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
               MeasuredPulse& measured) const;
  void find_statuses(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
                     MeasuredPulse& measured) const;
  void measure(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
               MeasuredPulse& measured) const;
  void record(const PulseInput& pulse, std::size_t slot, PulseBatch& batch, PulseWorkspace& workspace) const;
  void record_estimate(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                       PulseWorkspace& workspace) const;
  void record_truth(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                    PulseWorkspace& workspace) const;
  static void record_echoes(std::size_t first_row, PointColumns& out, const ReceivedPulse& received);
  static void record_later_echoes(EchoColumns& out, const ReceivedPulse& received);
  /// The report of the receiver for a pixel.
  struct Report {
    PointStatus status;
    double range_m;          ///< NaN without a return
    float intensity_pe;      ///< NaN without a return or a receiver
    std::int8_t number = 0;  ///< return_number
  };
  [[nodiscard]] Report report(PulsePixel where, const PulseWorkspace& workspace) const;

  Lidar lidar_;
  const RayEngine* engine_;
  const TerrainSurface* terrain_;
  const SurfaceAlbedo* albedo_;
  std::vector<std::int8_t> dead_map_;
};

}  // namespace landfall
