// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D346
//
// A lidar below a mesh's H is not an error: it may be under an overhang or in a cave. Inside a closed body
// it sees the body from within.
#include "chain/lidar/simulation/pulse_simulator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "base/numerics/light.h"
#include "base/numerics/non_finite.h"
#include "chain/lidar/simulation/beam_points.h"
#include "chain/lidar/simulation/echo_columns.h"
#include "chain/lidar/simulation/incidence.h"
#include "chain/lidar/simulation/pattern_aim.h"

namespace landfall {
namespace {

constexpr float kNoIntensity = std::numeric_limits<float>::quiet_NaN();

[[noreturn]] void refuse_origin(std::int64_t pulse, const Point<DemFrame>& origin, double terrain_m) {
  std::ostringstream message;
  message.precision(10);
  message << "pulse " << pulse << ": the lidar at x = " << origin.v.x() << " m, y = " << origin.v.y()
          << " m is " << origin.v.z() << " m high, at or below the terrain, " << terrain_m << " m";
  throw FormatError(message.str());
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
  if (hits_m.size() == beams.size()) return;
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

PulseSimulator::PulseSimulator(Lidar lidar, const RayEngine* engine, const TerrainSurface* terrain,
                               const SurfaceAlbedo* albedo)
    : lidar_(std::move(lidar)),
      engine_(engine),
      terrain_(terrain),
      albedo_(albedo),
      dead_map_(dead_map_of(lidar_)) {
  if (lidar_.range_errors.needs_incidence() && terrain_ == nullptr)
    throw UsageError(std::string(kIncidenceNoise) + ": needs the terrain's surface");
  if (lidar_.receiver.uses_waveforms() && engine_ != nullptr && terrain_ == nullptr)
    throw UsageError("receiver/type: needs the terrain's surface");
  assert(lidar_.link_constants_pe_m2.size() ==
         (lidar_.receiver.uses_waveforms() ? lidar_.detector.samples().size() : 0));
}

void PulseSimulator::simulate(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                              PulseWorkspace& workspace) const {
  steer_to_trace(pulse, workspace.aimed);
  make_rays(pulse, workspace.aimed, workspace.traced);
  trace(workspace.traced.rays, workspace.traced.hits_m);
  if (!workspace.aimed.state.blanked)
    spread_over(traced_beams(workspace.aimed, workspace.traced), workspace.traced.hits_m);
  combine_samples(pulse.time.pulse, workspace.aimed, workspace.traced, workspace.received);
  record(pulse, slot, batch, workspace);
}

void PulseSimulator::replay(const PulseInput& pulse, const TrueRanges& truth, std::size_t slot,
                            PulseBatch& batch, PulseWorkspace& workspace) const {
  load_true_ranges(pulse, truth, workspace);
  record(pulse, slot, batch, workspace);
}

void PulseSimulator::prepare_replay(const PulseInput& pulse, const TrueRanges& truth,
                                    PulseWorkspace& workspace) const {
  load_true_ranges(pulse, truth, workspace);
  find_incidences(workspace.aimed, workspace.received, workspace.measured);
}

void PulseSimulator::load_true_ranges(const PulseInput& pulse, const TrueRanges& truth,
                                      PulseWorkspace& workspace) const {
  steer(pulse, workspace.aimed);
  ReceivedPulse& received = workspace.received;
  received.ranges_m.assign(truth.ranges_m.begin(), truth.ranges_m.end());
  received.echoes.assign(truth.echoes.begin(), truth.echoes.end());
  const auto pulse_of = [](const LaterEcho& echo) { return echo.where.pulse; };
  received.later_echoes.assign(std::ranges::lower_bound(truth.later, pulse.time.pulse, {}, pulse_of),
                               std::ranges::upper_bound(truth.later, pulse.time.pulse, {}, pulse_of));
}

Transform<BodyFrame, LidarFrame> PulseSimulator::true_mount(std::int64_t pulse) const {
  if (!lidar_.pointing_error.turns_beams()) return lidar_.mount;
  return {lidar_.mount.rotation * lidar_.pointing_error.rotation(pulse), lidar_.mount.position};
}

PulseContext PulseSimulator::context_of(const PulseInput& pulse, double mirror_time_error_s) const {
  PulseContext context{.time = {pulse.time.pulse, pulse.time.since_start_s + mirror_time_error_s}};
  const Pattern* const pattern = lidar_.pattern.get();
  if (pattern == nullptr || !pattern->aim_point(pulse.time)) return context;
  const PatternAim aim(*pattern, pulse.interval_s);
  const auto [near, later_s] = aim.time_after(pulse.time, mirror_time_error_s);
  const Point<DemFrame> target = later_s == 0 ? *pattern->aim_point(near) : aim.at(near, later_s);
  const Transform<DemFrame, LidarFrame> T_dem_lidar = pulse.nominal * lidar_.mount;
  context.aim = direction_to(target, T_dem_lidar);
  const ContextNeeds needs = lidar_.scanner->needs();
  if (needs.jumps) {
    if (const auto jump = pattern->last_jump(near)) {
      context.since_jump_s = std::max(0.0, jump->since_s + later_s);
      if (const auto before = pattern->aim_point(jump->before))
        context.aim_before_jump = direction_to(*before, T_dem_lidar);
      if (needs.motion && context.aim_before_jump && pulse.interval_s > 0)
        context.jump_aims = aim.around(*jump, near, T_dem_lidar);
    }
  }
  if (needs.echo) {
    const double distance_m = (target - T_dem_lidar.position).norm();
    context.aim_at_echo =
        direction_to(aim.at(near, later_s + 2 * distance_m / kSpeedOfLight_mps), T_dem_lidar);
  }
  return context;
}

void PulseSimulator::steer(const PulseInput& pulse, AimedPulse& aimed) const {
  const Scanner& scanner = *lidar_.scanner;
  const PulseContext context = context_of(pulse, 0);
  const ScannerState on_time = scanner.state(context);
  const double mirror_time_error_s = lidar_.pointing_error.mirror_time_error_s(pulse.time.pulse);
  aimed.state = on_time;
  if (mirror_time_error_s != 0) {
    aimed.state = scanner.state(context_of(pulse, mirror_time_error_s));
    aimed.state.blanked = on_time.blanked;  // the laser keeps the lander's time
  }
  aimed.T_dem_lidar = pulse.truth * true_mount(pulse.time.pulse);
  if (lidar_.pattern && !context.aim) aimed.state.blanked = true;
  const auto pixels = lidar_.detector.pixels();
  aimed.beams.resize(pixels.size());
  scanner.steer(aimed.state, pixels, aimed.beams);
  aimed.estimated_beams.clear();
  if (scanner.is_known() && mirror_time_error_s == 0) return;
  aimed.estimated_beams.resize(pixels.size());
  scanner.steer(scanner.estimated_state(context, on_time), pixels, aimed.estimated_beams);
  for (std::size_t i = 0; i < pixels.size(); ++i)
    if (aimed.estimated_beams[i].lost) aimed.beams[i].lost = true;  // such a point has no estimate
}

std::span<const Beam> PulseSimulator::traced_beams(const AimedPulse& aimed, const TracedPulse& traced) const {
  return lidar_.detector.samples_per_pixel() > 1 ? traced.sample_beams : aimed.beams;
}

void PulseSimulator::make_rays(const PulseInput& pulse, const AimedPulse& aimed, TracedPulse& traced) const {
  if (aimed.state.blanked) return traced.rays.clear();
  if (lidar_.detector.samples_per_pixel() > 1) {
    std::vector<Beam>& samples = traced.sample_beams;
    samples.resize(lidar_.detector.samples().size());
    lidar_.scanner->steer(aimed.state, lidar_.detector.samples(), samples);
    if (lidar_.receiver.uses_waveforms())
      samples.insert(samples.end(), aimed.beams.begin(), aimed.beams.end());
  }
  const std::span<const Beam> beams = traced_beams(aimed, traced);
  traced.rays.resize(beams.size());
  std::size_t count = 0;
  const Beam* other =
      nullptr;  // the last one that left from another place: most scanners' beams leave from one
  Point<DemFrame> origin;
  for (const Beam& beam : beams) {
    if (beam.lost) continue;
    if (other == nullptr || beam.exit != other->exit) {
      other = &beam;
      origin = aimed.T_dem_lidar * beam.exit;
      require_above_terrain(pulse, origin);
    }
    traced.rays[count++] = {origin, aimed.T_dem_lidar.rotation * beam.direction};
  }
  traced.rays.resize(count);
}

void PulseSimulator::trace(std::span<const Ray> rays, std::vector<double>& hits_m) const {
  hits_m.resize(rays.size());
  assert(engine_ != nullptr);
  if (!rays.empty()) engine_->first_hits(rays, hits_m);
}

void PulseSimulator::combine_samples(std::int64_t pulse, const AimedPulse& aimed, TracedPulse& traced,
                                     ReceivedPulse& received) const {
  const bool uses_waveforms = lidar_.receiver.uses_waveforms();
  const std::size_t pixels = aimed.beams.size();
  received.ranges_m.assign(pixels, kNan);
  received.echoes.assign(uses_waveforms && lidar_.receiver.accepts_kept_echoes() ? pixels : 0, {});
  received.later_echoes.clear();
  if (aimed.state.blanked) return;
  if (uses_waveforms) return build_waveforms(pulse, aimed, traced, received);
  const std::size_t per_pixel = lidar_.detector.samples_per_pixel();
  if (per_pixel == 1) return received.ranges_m.swap(traced.hits_m);  // each rule gives a sample's own range
  for (std::size_t i = 0; i < pixels; ++i)
    if (!aimed.beams[i].lost)
      received.ranges_m[i] =
          lidar_.detector.estimator().range_m(std::span(traced.hits_m).subspan(i * per_pixel, per_pixel));
}

/// The pixels' own rays follow those of all samples, unless a pixel has a single sample.
void PulseSimulator::build_waveforms(std::int64_t pulse, const AimedPulse& aimed, TracedPulse& traced,
                                     ReceivedPulse& received) const {
  const std::size_t per_pixel = lidar_.detector.samples_per_pixel();
  const std::span<const Beam> beams = traced_beams(aimed, traced);
  const std::size_t first_own = beams.size() - aimed.beams.size();
  for (std::size_t i = 0; i < aimed.beams.size(); ++i)
    if (!aimed.beams[i].lost) received.ranges_m[i] = traced.hits_m[first_own + i];
  find_signals(traced, beams.first(lidar_.detector.samples().size()), received);
  received.waveforms.clear(per_pixel);
  for (std::size_t i = 0; i < aimed.beams.size(); ++i) {
    const std::size_t seen = std::isnan(received.ranges_m[i]) ? 0 : per_pixel;
    lidar_.receiver.add_pixel(std::span(traced.hits_m).subspan(i * per_pixel, seen),
                              std::span(received.signals_pe).subspan(i * per_pixel, seen),
                              received.waveforms);
  }
  lidar_.receiver.time(received.waveforms);
  if (lidar_.receiver.accepts_kept_echoes())
    lidar_.receiver.keep_echoes(pulse, received.waveforms, received.echoes, received.later_echoes);
}

void PulseSimulator::find_signals(const TracedPulse& traced, std::span<const Beam> samples,
                                  ReceivedPulse& received) const {
  ReceivedPulse& r = received;
  r.hits.clear();
  r.hit_directions.clear();
  for (std::size_t i = 0, ray = 0; i < samples.size(); ++i) {
    if (samples[i].lost) continue;
    const Ray& sent = traced.rays[ray++];
    if (std::isnan(traced.hits_m[i])) continue;
    r.hits.push_back(sent.origin.v + traced.hits_m[i] * sent.direction.v);
    r.hit_directions.push_back(sent.direction.v);
  }
  r.cosines.resize(r.hits.size());
  terrain_->cosines(r.hits, r.hit_directions, r.cosines);
  r.signals_pe.assign(samples.size(), kNan);
  for (std::size_t i = 0, hit = 0; i < samples.size(); ++i) {
    const double range_m = traced.hits_m[i];
    if (std::isnan(range_m)) continue;
    double signal_pe = lidar_.link_constants_pe_m2[i] / (range_m * range_m);
    if (!std::isnan(r.cosines[hit])) signal_pe *= r.cosines[hit];  // NaN on the edge of a hole
    if (albedo_ != nullptr) signal_pe *= albedo_->at(r.hits[hit].x(), r.hits[hit].y());
    r.signals_pe[i] = signal_pe;
    ++hit;
  }
}

void PulseSimulator::steer_to_trace(const PulseInput& pulse, AimedPulse& aimed) const {
  try {
    steer(pulse, aimed);
  } catch (const FormatError&) {
    require_above_terrain(pulse, (pulse.truth * true_mount(pulse.time.pulse)).position);
    throw;
  }
}

void PulseSimulator::require_above_terrain(const PulseInput& pulse, const Point<DemFrame>& origin) const {
  if (terrain_ == nullptr || !terrain_->is_terrain_below() || origin.v.z() > terrain_->highest_m()) return;
  const double terrain_m = terrain_->elevation(origin.v.x(), origin.v.y());
  if (origin.v.z() <= terrain_m) refuse_origin(pulse.time.pulse, origin, terrain_m);
}

void PulseSimulator::find_statuses(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
                                   MeasuredPulse& measured) const {
  const std::size_t pixels = aimed.beams.size();
  measured.is_dropped.resize(pixels);
  lidar_.range_errors.find_dropouts(pulse, measured.is_dropped);
  measured.statuses.resize(pixels);
  const std::span<PointStatus> statuses = measured.statuses;
  const std::size_t max_count = lidar_.receiver.max_returns();
  for (std::size_t i = 0; i < pixels; ++i) {  // the last that applies stays
    PointStatus what = measured.is_dropped[i] != 0 ? PointStatus::dropout : PointStatus::returned;
    if (!measured.detections.empty() && std::isnan(measured.detections[i * max_count].range_m))
      what = PointStatus::undetected;
    if (std::isnan(received.ranges_m[i])) what = PointStatus::miss;
    if (aimed.beams[i].lost) what = PointStatus::lost_in_optics;
    if (aimed.state.blanked) what = PointStatus::blanked;
    if (dead_map_[i] != 0) what = PointStatus::dead;
    statuses[i] = what;
  }
}

PulseSimulator::Report PulseSimulator::report(PulsePixel where, const PulseWorkspace& workspace) const {
  const auto i = static_cast<std::size_t>(where.pixel);
  const auto number = static_cast<std::size_t>(where.number);
  const PointStatus what = workspace.measured.statuses[i];
  const bool has_echo = what == PointStatus::returned;
  const bool may_be_false = has_echo || what == PointStatus::miss || what == PointStatus::undetected ||
                            what == PointStatus::dropout;
  if (number == 0 && may_be_false && lidar_.range_errors.has_false_returns()) {
    // The first detection is reported. The true range decides, so that other errors do not change the choice.
    const std::optional<double> false_m = lidar_.range_errors.false_return_m(where);
    if (false_m && !(has_echo && *false_m >= workspace.received.ranges_m[i]))
      return {PointStatus::false_return, *false_m, kNoIntensity, 1};
  }
  if (workspace.measured.detections.empty())
    return {what, has_echo ? workspace.measured.measured_m[i] : kNan, kNoIntensity};
  const Detection& detection = workspace.measured.detections[i * lidar_.receiver.max_returns() + number];
  const bool is_background = detection.is_background && (has_echo || what == PointStatus::miss);
  if (!is_background && (!has_echo || std::isnan(detection.range_m)))
    return {what, kNan, kNoIntensity, number == 0 ? std::int8_t{0} : PulseBatch::kNoSuchReturn};
  return {is_background ? PointStatus::false_return : what,
          workspace.measured.measured_m[number * workspace.aimed.beams.size() + i], detection.intensity_pe,
          static_cast<std::int8_t>(number + 1)};
}

void PulseSimulator::find_incidences(const AimedPulse& aimed, const ReceivedPulse& received,
                                     MeasuredPulse& measured) const {
  measured.tan_incidences.clear();
  if (!lidar_.range_errors.needs_incidence()) return;
  for (std::size_t i = 0; i < aimed.beams.size(); ++i) {
    const Beam& beam = aimed.beams[i];
    const double tangent =
        tan_incidence(*terrain_, aimed.T_dem_lidar * (beam.exit + received.ranges_m[i] * beam.direction),
                      aimed.T_dem_lidar.rotation * beam.direction);
    // a miss, where the receiver may still report background
    measured.tan_incidences.push_back(std::isnan(tangent) ? 0 : tangent);
  }
}

void PulseSimulator::measure(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
                             MeasuredPulse& measured) const {
  MeasuredPulse& m = measured;
  find_incidences(aimed, received, m);
  const std::size_t pixels = aimed.beams.size();
  const std::size_t max_count = lidar_.receiver.max_returns();
  receive(pulse, aimed, received, m);
  find_statuses(pulse, aimed, received, m);
  m.measured_m.resize(pixels * max_count);
  for (std::size_t number = 0; number < max_count; ++number) {
    const std::span<double> measured_m = std::span(m.measured_m).subspan(number * pixels, pixels);
    const auto n = static_cast<std::int64_t>(number);
    std::span<const double> reported_m = received.ranges_m;
    if (!m.detections.empty()) {
      for (std::size_t i = 0; i < pixels; ++i) m.reported_m[i] = m.detections[i * max_count + number].range_m;
      reported_m = m.reported_m;
    }
    lidar_.range_errors.measure(pulse, reported_m, m.tan_incidences, measured_m, n);
    lidar_.range_timer.apply(pulse, n, measured_m);
  }
}

void PulseSimulator::receive(std::int64_t pulse, const AimedPulse& aimed, const ReceivedPulse& received,
                             MeasuredPulse& measured) const {
  const Receiver& receiver = lidar_.receiver;
  measured.detections.clear();
  if (!receiver.uses_waveforms()) return;
  measured.detections.resize(rows_per_pulse());
  measured.reported_m.resize(aimed.beams.size());
  if (aimed.state.blanked) return;
  if (receiver.accepts_kept_echoes()) {
    receiver.receive(pulse, received.echoes, received.later_echoes, measured.detections);
  } else {
    receiver.receive(pulse, received.waveforms, measured.detections);
  }
}

void PulseSimulator::record(const PulseInput& pulse, std::size_t slot, PulseBatch& batch,
                            PulseWorkspace& workspace) const {
  const std::size_t rows = rows_per_pulse();
  record_pulse(pulse, workspace.aimed.state, slot, batch.pulses);
  batch.pulses.point_count[slot] = static_cast<std::int32_t>(rows);
  measure(pulse.time.pulse, workspace.aimed, workspace.received, workspace.measured);
  const std::size_t first_row = slot * rows;
  record_estimate(pulse, first_row, batch.points, workspace);
  if (batch.keeps_later_echoes) record_later_echoes(batch.later_echoes, workspace.received);
  if (!batch.points.holds_truth()) return;
  record_truth(pulse, first_row, batch.points, workspace);
  if (batch.points.holds_echoes()) record_echoes(first_row, batch.points, workspace.received);
}

void PulseSimulator::record_echoes(std::size_t first_row, PointColumns& out, const ReceivedPulse& received) {
  for (std::size_t i = 0; i < received.echoes.size(); ++i) {
    for (const EchoMember& part : kEchoMembers)
      (out.*part.first)[first_row + i] = received.echoes[i].*part.member;
  }
}

void PulseSimulator::record_later_echoes(EchoColumns& out, const ReceivedPulse& received) {
  for (const auto& [where, echo] : received.later_echoes) {
    out.pulse.push_back(static_cast<std::int32_t>(where.pulse));
    out.pixel.push_back(static_cast<std::int32_t>(where.pixel));
    out.number.push_back(static_cast<std::int32_t>(where.number));
    for (const EchoMember& part : kEchoMembers) (out.*part.later).push_back(echo.*part.member);
  }
}

void PulseSimulator::record_estimate(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                                     PulseWorkspace& workspace) const {
  const MeasuredPulse& measured = workspace.measured;
  const std::size_t pixels = dead_map_.size();
  const std::size_t max_count = lidar_.receiver.max_returns();
  std::vector<double>& ranges_m = workspace.row_measured_m;
  ranges_m.resize(rows_per_pulse());
  const bool is_plain = measured.detections.empty() && !lidar_.range_errors.has_false_returns() &&
                        out.intensity.empty() && out.return_number.empty();
  if (is_plain) {
    std::ranges::copy(measured.statuses, &out.status[first_row]);
    for (std::size_t i = 0; i < pixels; ++i)
      ranges_m[i] = measured.statuses[i] == PointStatus::returned ? measured.measured_m[i] : kNan;
  } else {
    for (std::size_t k = 0; k < ranges_m.size(); ++k) {
      const Report said = report({pulse.time.pulse, static_cast<std::int64_t>(k / max_count),
                                  static_cast<std::int64_t>(k % max_count)},
                                 workspace);
      const std::size_t row = first_row + k;
      ranges_m[k] = said.range_m;
      out.status[row] = said.status;
      if (!out.intensity.empty()) out.intensity[row] = said.intensity_pe;
      if (!out.return_number.empty()) out.return_number[row] = said.number;
    }
  }
  if (!out.range_measured.empty()) std::ranges::copy(ranges_m, &out.range_measured[first_row]);
  const AimedPulse& aimed = workspace.aimed;
  beam_points(pulse.estimate * lidar_.mount,
              aimed.estimated_beams.empty() ? aimed.beams : aimed.estimated_beams, ranges_m,
              {&out.x_est[first_row], &out.y_est[first_row], &out.z_est[first_row]});
}

void PulseSimulator::record_truth(const PulseInput& pulse, std::size_t first_row, PointColumns& out,
                                  PulseWorkspace& workspace) const {
  const std::size_t max_count = lidar_.receiver.max_returns();
  const std::size_t rows = rows_per_pulse();
  std::vector<double>& shown_m = workspace.row_shown_m;
  shown_m.resize(rows);
  for (std::size_t i = 0, k = 0; k < rows; ++i) {
    const double range_m = workspace.received.ranges_m[i];
    for (const std::size_t end = k + max_count; k < end; ++k) {
      const bool has_no_hit = std::isnan(range_m) && out.status[first_row + k] == PointStatus::false_return;
      shown_m[k] = has_no_hit ? workspace.row_measured_m[k] : range_m;
    }
  }
  beam_points(workspace.aimed.T_dem_lidar, workspace.aimed.beams, shown_m,
              {&out.x_true[first_row], &out.y_true[first_row], &out.z_true[first_row]});
  if (out.range_true.empty()) return;
  for (std::size_t i = 0, row = first_row; row < first_row + rows; ++i) {
    for (const std::size_t end = row + max_count; row < end; ++row) {
      out.range_true[row] = workspace.received.ranges_m[i];
      out.pulse[row] = static_cast<std::int32_t>(pulse.time.pulse);
      out.pixel[row] = static_cast<std::int32_t>(i);
    }
  }
}

}  // namespace landfall
