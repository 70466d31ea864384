// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/pulse_simulator.h"

#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "simulation/incidence.h"

namespace landfall {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSpeedOfLight_mps = 299792458;

/// The direction from the lidar, at this pose, to a point.
Direction<LidarFrame> direction_to(const Point<DemFrame>& target,
                                   const Transform<DemFrame, LidarFrame>& T_dem_lidar) {
  return Direction<LidarFrame>::of(T_dem_lidar.rotation.inverse() * (target - T_dem_lidar.position));
}

[[noreturn]] void refuse_origin(std::int64_t pulse, const Point<DemFrame>& origin, double ground_m) {
  std::ostringstream message;
  message.precision(10);
  message << "pulse " << pulse << ": the lidar at x = " << origin.v.x() << " m, y = " << origin.v.y()
          << " m is " << origin.v.z() << " m high, at or below the terrain, " << ground_m << " m";
  throw FormatError(message.str());
}

PulseTime pulse_ahead(const PulseInput& pulse, std::int64_t ahead) {
  return {pulse.time.pulse + ahead, pulse.time.since_start_s + static_cast<double>(ahead) * pulse.interval_s};
}

/// The offset of the last pulse before the pattern's next jump; `most` if it does not jump before.
std::int64_t pulses_without_jump(const Pattern& pattern, const PulseInput& pulse, std::int64_t most) {
  while (const auto jump = pattern.last_jump(pulse_ahead(pulse, most))) {
    const std::int64_t before = jump->before.pulse - pulse.time.pulse;
    if (before < 0) break;
    most = before;
  }
  return most;
}

/// The point that the pattern aims at `later_s` after a pulse, moving linearly from pulse to pulse. Before a
/// jump or a pulse without an aim it extrapolates from the two previous pulses.
Point<DemFrame> aim_after(const Pattern& pattern, const PulseInput& pulse, double later_s) {
  const double pulses = pulse.interval_s > 0 ? later_s / pulse.interval_s : 0;
  const auto aim = [&](std::int64_t ahead) { return pattern.ground_aim(pulse_ahead(pulse, ahead)); };
  const std::int64_t wanted = static_cast<std::int64_t>(pulses) + 1;
  const std::int64_t last = pulses_without_jump(pattern, pulse, wanted);
  std::int64_t to = last;
  while (to > 0 && !aim(to)) --to;
  std::int64_t from = to - 1;
  if (pulse.time.pulse + from < 0) return *aim(to);
  if (to == 0) {
    const auto jump = pattern.last_jump(pulse.time);
    if (jump && jump->before.pulse == pulse.time.pulse - 1) return *aim(0);  // the step lasts a single pulse
  }
  const auto start = aim(from);
  if (!start) return *aim(to);
  return *start + (pulses - static_cast<double>(from)) * (*aim(to) - *start);
}

/// The columns of a true or an estimated pose.
struct PoseColumns {
  std::vector<double>&px, &py, &pz, &qw, &qx, &qy, &qz;
};

void record_pose(const Pose& pose, std::size_t slot, const PoseColumns& columns) {
  Eigen::Quaterniond q(pose.rotation.m);
  if (q.w() < 0) q.coeffs() *= -1;  // q and -q are the same attitude; the file holds the one with w >= 0
  columns.px[slot] = pose.position.v.x();
  columns.py[slot] = pose.position.v.y();
  columns.pz[slot] = pose.position.v.z();
  columns.qw[slot] = q.w();
  columns.qx[slot] = q.x();
  columns.qy[slot] = q.y();
  columns.qz[slot] = q.z();
}

void record_pulse(const PulseInput& pulse, const ScannerState& state, std::size_t slot, PulseColumns& out) {
  out.t[slot] = pulse.t_s;
  out.angle_1[slot] = state.angle_1_rad;
  out.angle_2[slot] = state.angle_2_rad;
  record_pose(pulse.truth, slot,
              {out.px_true, out.py_true, out.pz_true, out.qw_true, out.qx_true, out.qy_true, out.qz_true});
  record_pose(pulse.estimate, slot,
              {out.px_est, out.py_est, out.pz_est, out.qw_est, out.qx_est, out.qy_est, out.qz_est});
}

/// Expands the engine's ranges, which omit the lost beams, to all beams.
void spread_over(std::span<const Beam> beams, std::vector<double>& hits_m) {
  std::size_t from = hits_m.size();
  hits_m.resize(beams.size());
  for (std::size_t i = beams.size(); i-- > 0;) hits_m[i] = beams[i].lost ? kNan : hits_m[--from];
}

std::vector<std::int8_t> dead_map_of(const Lidar& lidar) {
  std::vector<std::int8_t> dead(lidar.detector.pixel_count());
  for (std::size_t i = 0; i < dead.size(); ++i)
    dead[i] = lidar.range_errors.is_dead(static_cast<std::int64_t>(i)) ? 1 : 0;
  return dead;
}

}  // namespace

PulseSimulator::PulseSimulator(Lidar lidar, const RayEngine* engine, const TerrainSurface* ground)
    : lidar_(std::move(lidar)), engine_(engine), ground_(ground), dead_map_(dead_map_of(lidar_)) {
  if (lidar_.range_errors.needs_incidence() && ground_ == nullptr)
    throw UsageError("incidence_sigma_rad: needs the terrain's surface");
}

void PulseSimulator::simulate(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                              PulseWorkspace& workspace) const {
  steer(pulse, workspace);
  trace(pulse, workspace);
  record(pulse, slot, batch, workspace);
}

void PulseSimulator::replay(const PulseInput& pulse, std::span<const double> ranges_true_m, std::size_t slot,
                            PulseBatch& batch, PulseWorkspace& workspace) const {
  steer(pulse, workspace);
  workspace.ranges_m.assign(ranges_true_m.begin(), ranges_true_m.end());
  record(pulse, slot, batch, workspace);
}

Transform<BodyFrame, LidarFrame> PulseSimulator::true_mount(std::int64_t pulse) const {
  if (!lidar_.pointing_error.turns_beams()) return lidar_.mount;
  return {lidar_.mount.rotation * lidar_.pointing_error.turn(pulse), lidar_.mount.position};
}

PulseContext PulseSimulator::context_of(const PulseInput& pulse) const {
  PulseContext context{.time = pulse.time};
  const Pattern* const pattern = lidar_.pattern.get();
  const auto target = pattern != nullptr ? pattern->ground_aim(pulse.time) : std::nullopt;
  if (!target) return context;
  const Transform<DemFrame, LidarFrame> T_dem_lidar = pulse.nominal * lidar_.mount;
  context.aim = direction_to(*target, T_dem_lidar);
  const ContextNeeds needs = lidar_.scanner->needs();
  if (needs.jumps) {
    if (const auto jump = pattern->last_jump(pulse.time)) {
      context.since_jump_s = jump->since_s;
      if (const auto before = pattern->ground_aim(jump->before))
        context.aim_before_jump = direction_to(*before, T_dem_lidar);
    }
  }
  if (needs.echo) {
    const double distance_m = (*target - T_dem_lidar.position).norm();
    const Point<DemFrame> later = aim_after(*pattern, pulse, 2 * distance_m / kSpeedOfLight_mps);
    context.aim_at_echo = direction_to(later, T_dem_lidar);
  }
  return context;
}

void PulseSimulator::steer(const PulseInput& pulse, PulseWorkspace& workspace) const {
  const Scanner& scanner = *lidar_.scanner;
  const PulseContext context = context_of(pulse);
  workspace.state = scanner.state(context);
  workspace.T_dem_lidar = pulse.truth * true_mount(pulse.time.pulse);
  if (lidar_.pattern && !context.aim) workspace.state.blanked = true;
  const auto pixels = lidar_.detector.pixels();
  workspace.beams.resize(pixels.size());
  scanner.steer(workspace.state, pixels, workspace.beams);
  workspace.believed_beams.clear();
  if (scanner.is_known()) return;
  workspace.believed_beams.resize(pixels.size());
  scanner.steer(scanner.believed_state(context, workspace.state), pixels, workspace.believed_beams);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (workspace.believed_beams[i].lost) workspace.beams[i].lost = true;  // such a point has no estimate
}

void PulseSimulator::trace(const PulseInput& pulse, PulseWorkspace& workspace) const {
  PulseWorkspace& w = workspace;
  w.ranges_m.assign(w.beams.size(), kNan);
  if (w.state.blanked) return;
  const std::size_t per_pixel = lidar_.detector.samples_per_pixel();
  std::span<const Beam> beams = w.beams;
  if (per_pixel > 1) {
    w.sample_beams.resize(lidar_.detector.samples().size());
    lidar_.scanner->steer(w.state, lidar_.detector.samples(), w.sample_beams);
    beams = w.sample_beams;
  }
  w.rays.clear();
  for (const Beam& beam : beams)
    if (!beam.lost) w.rays.push_back({w.T_dem_lidar * beam.exit, w.T_dem_lidar.rotation * beam.direction});
  require_above_ground(pulse, w.rays);
  w.hits_m.resize(w.rays.size());
  assert(engine_ != nullptr);
  engine_->first_hits(w.rays, w.hits_m);
  if (w.rays.size() < beams.size()) spread_over(beams, w.hits_m);
  for (std::size_t i = 0; i < w.beams.size(); ++i)
    if (!w.beams[i].lost)
      w.ranges_m[i] =
          lidar_.detector.estimator().range_m(std::span(w.hits_m).subspan(i * per_pixel, per_pixel));
}

void PulseSimulator::require_above_ground(const PulseInput& pulse, std::span<const Ray> rays) const {
  if (ground_ == nullptr || !ground_->is_ground_below()) return;
  const double highest_m = ground_->highest_m();
  const Point<DemFrame>* checked = nullptr;
  for (const Ray& ray : rays) {
    if (checked != nullptr && ray.origin == *checked) continue;
    checked = &ray.origin;
    if (ray.origin.v.z() > highest_m) continue;
    const double ground_m = ground_->elevation(ray.origin.v.x(), ray.origin.v.y());
    if (ray.origin.v.z() <= ground_m) refuse_origin(pulse.time.pulse, ray.origin, ground_m);
  }
}

PointStatus PulseSimulator::status(PulsePixel where, const PulseWorkspace& workspace) const {
  const auto i = static_cast<std::size_t>(where.pixel);
  if (dead_map_[i] != 0) return PointStatus::dead;
  if (workspace.state.blanked) return PointStatus::blanked;
  if (workspace.beams[i].lost) return PointStatus::lost_in_optics;
  if (std::isnan(workspace.ranges_m[i])) return PointStatus::miss;
  return lidar_.range_errors.is_dropped(where) ? PointStatus::dropout : PointStatus::returned;
}

PulseSimulator::Report PulseSimulator::report(PulsePixel where, const PulseWorkspace& workspace) const {
  const auto i = static_cast<std::size_t>(where.pixel);
  const PointStatus what = status(where, workspace);
  const bool has_echo = what == PointStatus::returned;
  const bool can_be_false = lidar_.range_errors.has_false_returns() &&
                            (has_echo || what == PointStatus::miss || what == PointStatus::dropout);
  if (can_be_false) {
    // The first detection is reported. The true range decides, so that other errors do not change the choice.
    const std::optional<double> false_m = lidar_.range_errors.false_range_m(where);
    if (false_m && !(has_echo && *false_m >= workspace.ranges_m[i]))
      return {PointStatus::false_return, *false_m};
  }
  return {what, has_echo ? workspace.measured_m[i] : kNan};
}

void PulseSimulator::measure(const PulseInput& pulse, PulseWorkspace& workspace) const {
  PulseWorkspace& w = workspace;
  w.tan_incidences.clear();
  if (lidar_.range_errors.needs_incidence())
    for (std::size_t i = 0; i < w.beams.size(); ++i)
      w.tan_incidences.push_back(
          tan_incidence(*ground_, w.T_dem_lidar * (w.beams[i].exit + w.ranges_m[i] * w.beams[i].direction),
                        w.T_dem_lidar.rotation * w.beams[i].direction));
  w.measured_m.resize(w.beams.size());
  lidar_.range_errors.measure(pulse.time.pulse, w.ranges_m, w.tan_incidences, w.measured_m);
}

void PulseSimulator::record(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                            PulseWorkspace& workspace) const {
  const std::size_t pixel_count = workspace.beams.size();
  record_pulse(pulse, workspace.state, slot, batch.pulses);
  batch.pulses.point_count[slot] = static_cast<std::int32_t>(pixel_count);
  measure(pulse, workspace);
  const std::size_t first_row = slot * pixel_count;
  record_estimate(pulse, first_row, batch.points, workspace);
  if (batch.points.holds_truth()) record_truth(pulse, first_row, batch.points, workspace);
}

// A NaN range gives a NaN point.
void PulseSimulator::record_estimate(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                                     const PulseWorkspace& workspace) const {
  const Transform<DemFrame, LidarFrame> T_dem_lidar_est = pulse.estimate * lidar_.mount;
  const std::vector<Beam>& beams =
      workspace.believed_beams.empty() ? workspace.beams : workspace.believed_beams;
  for (std::size_t i = 0; i < beams.size(); ++i) {
    const Beam& beam = beams[i];
    const auto [what, measured] = report({pulse.time.pulse, static_cast<std::int64_t>(i)}, workspace);
    const Point<DemFrame> estimate = T_dem_lidar_est * (beam.exit + measured * beam.direction);
    const std::size_t row = first_row + i;
    out.x_est[row] = estimate.v.x();
    out.y_est[row] = estimate.v.y();
    out.z_est[row] = estimate.v.z();
    out.range_measured[row] = measured;
    out.status[row] = what;
  }
}

void PulseSimulator::record_truth(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                                  const PulseWorkspace& workspace) {
  for (std::size_t i = 0; i < workspace.beams.size(); ++i) {
    const Beam& beam = workspace.beams[i];
    const double range = workspace.ranges_m[i];
    const std::size_t row = first_row + i;
    const bool has_no_hit = out.status[row] == PointStatus::false_return && std::isnan(range);
    const double shown = has_no_hit ? out.range_measured[row] : range;
    const Point<DemFrame> truth = workspace.T_dem_lidar * (beam.exit + shown * beam.direction);
    out.x_true[row] = truth.v.x();
    out.y_true[row] = truth.v.y();
    out.z_true[row] = truth.v.z();
    out.range_true[row] = range;
    out.pulse[row] = static_cast<std::int32_t>(pulse.time.pulse);
    out.pixel[row] = static_cast<std::int32_t>(i);
  }
}

}  // namespace landfall
