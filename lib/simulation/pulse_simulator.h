// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <numbers>
#include <span>
#include <vector>

#include "detector/detector.h"
#include "error_models/pointing_error.h"
#include "error_models/range_errors.h"
#include "geometry/rotation.h"
#include "ray/engine.h"
#include "scanner/pattern.h"
#include "scanner/scanner.h"
#include "simulation/pulse_batch.h"
#include "terrain/surface.h"
#include "trajectory/trajectory.h"

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
};

/// One pulse, as the caller that moves the lander defines it.
struct PulseInput {
  PulseTime time{};
  double t_s = 0;         ///< as written to the pulse table
  double interval_s = 0;  ///< to the next pulse; 0: the aim is taken as constant
  Pose truth{};
  Pose estimate{};  ///< what the lander believes
  Pose nominal{};   ///< the pose that the pattern aims from
};

/// Memory that a thread reuses between pulses. Its contents have no meaning for the caller.
struct PulseWorkspace {
  ScannerState state;
  std::vector<Beam> beams;
  std::vector<Beam> believed_beams;  ///< empty where the scanner is known: equal to `beams`
  std::vector<Beam> sample_beams;
  std::vector<Ray> rays;
  std::vector<double> hits_m;
  std::vector<double> ranges_m;
  std::vector<double> tan_incidences;  ///< empty where the noise does not depend on them
  std::vector<double> measured_m;
  Transform<DemFrame, LidarFrame> T_dem_lidar;  ///< the true lidar
};

/// One pulse from poses to points, independent of a Trajectory: a host simulator can step it with its own
/// poses and RayEngine. The result depends on the arguments only: any thread may compute any pulse.
///
/// The true beam leaves from the true pose and mount (PointingError), aimed from the nominal ones: navigation
/// error never moves it. A point is s = p + R (p_BL + R_BL (b + r n)) (Eqs. 1 and 7). The true point uses the
/// true range, mount and pose; the estimated point uses the measured range, the nominal mount and the
/// estimated pose. Both use the same n and b unless the lander does not know the mechanism's state
/// (Scanner::is_known). A pixel's status is the first that applies of dead, blanked, total reflection, miss,
/// dropout. A false return may replace a miss, a dropout or a return from farther away.
///
/// The caller applies time-stamp errors when it chooses the estimated poses.
class PulseSimulator {
 public:
  /// `engine` must outlive this object; if it is null, only replay() may be called. `ground` must outlive it
  /// too; if given, a beam that starts at or below it is refused (for surfaces with ground below). Throws
  /// UsageError if it is missing and the noise depends on the incidence.
  PulseSimulator(Lidar lidar, const RayEngine* engine, const TerrainSurface* ground);

  [[nodiscard]] const Lidar& lidar() const { return lidar_; }
  /// 1 for each dead pixel, 0 for the others, row-major.
  [[nodiscard]] std::span<const std::int8_t> dead_map() const { return dead_map_; }

  /// Fills pulse `slot` of `batch`, which has been resized to this detector's pixels; the truth only where
  /// the batch holds it. All rays of the pulse go to the engine in one call, in pixel order and, within a
  /// pixel, in sub-pixel order. Throws FormatError, naming the pulse, where the scanner cannot follow the
  /// aim, or for a beam that starts at or below the ground.
  void simulate(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                PulseWorkspace& workspace) const;

  /// simulate() without tracing: the true ranges come from an earlier run, one per pixel, NaN for a miss.
  void replay(const PulseInput& pulse, std::span<const double> ranges_true_m, std::size_t slot,
              PulseBatch& batch, PulseWorkspace& workspace) const;

 private:
  [[nodiscard]] Transform<BodyFrame, LidarFrame> true_mount(std::int64_t pulse) const;
  [[nodiscard]] PulseContext context_of(const PulseInput& pulse) const;
  void steer(const PulseInput& pulse, PulseWorkspace& workspace) const;
  void trace(const PulseInput& pulse, PulseWorkspace& workspace) const;
  void require_above_ground(const PulseInput& pulse, std::span<const Ray> rays) const;
  void measure(const PulseInput& pulse, PulseWorkspace& workspace) const;
  void record(const PulseInput& pulse, std::size_t slot, PulseBatch& batch, PulseWorkspace& workspace) const;
  void record_estimate(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                       const PulseWorkspace& workspace) const;
  static void record_truth(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                           const PulseWorkspace& workspace);
  [[nodiscard]] PointStatus status(PulsePixel where, const PulseWorkspace& workspace) const;
  /// What the receiver reports for a pixel.
  struct Report {
    PointStatus status;
    double range_m;  ///< NaN without a return
  };
  [[nodiscard]] Report report(PulsePixel where, const PulseWorkspace& workspace) const;

  Lidar lidar_;
  const RayEngine* engine_;
  const TerrainSurface* ground_;
  std::vector<std::int8_t> dead_map_;
};

}  // namespace landfall
