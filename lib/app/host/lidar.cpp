// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D97
//
// The module is configured by JSON like scan-sim, and its header exposes none of landfall's own types: a
// host depends on one header and one archive, and a new component needs no new interface.
#include "app/host/lidar.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <utility>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/returns/point_status.h"
#include "base/text/parameter_check.h"
#include "chain/lidar/simulation/pulse_simulator.h"
#include "store/config/json_source.h"
#include "store/config/scan_config.h"
#include "store/config/schema.h"

namespace landfall::lidar {
namespace {

// The public header repeats the statuses, so that it needs no other header.
static_assert(static_cast<std::size_t>(Status::undetected) + 1 == kPointStatusCount);
static_assert(static_cast<int>(Status::lost_in_optics) == static_cast<int>(PointStatus::lost_in_optics));

Vector3 array_of(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Ray ray_of(const landfall::Ray& ray) { return {array_of(ray.origin.v), array_of(ray.direction.v)}; }

landfall::Pose pose_of(const Pose& pose, const std::string& owner) {
  for (const double coordinate : pose.position_m) require_finite({owner, "position_m"}, coordinate);
  const auto& [w, x, y, z] = pose.attitude;
  const Eigen::Quaterniond attitude(w, x, y, z);
  const double norm = attitude.norm();
  require(std::abs(norm - 1) <= 1e-3, {owner, "attitude"}, norm, "a norm within 1e-3 of 1");
  const auto& [px, py, pz] = pose.position_m;
  return {{attitude.normalized().toRotationMatrix()}, {{px, py, pz}}};
}

double range_or_nan(double range_m) {
  return range_m >= 0 && std::isfinite(range_m) ? range_m : std::numeric_limits<double>::quiet_NaN();
}

/// Traces rays through the host's callback.
class CallbackEngine final : public RayEngine {
 public:
  explicit CallbackEngine(IntersectAll intersect) : intersect_(std::move(intersect)) {
    if (!intersect_) throw UsageError("intersect: no callback is given");
  }

  void first_hits(std::span<const landfall::Ray> rays, std::span<double> ranges) const override {
    intersect_(mapped(rays, ray_of), ranges);
    for (double& range : ranges) range = range_or_nan(range);
  }

 private:
  IntersectAll intersect_;
};

IntersectAll one_by_one(Intersect intersect) {
  if (!intersect) return {};
  return [intersect = std::move(intersect)](std::span<const Ray> rays, std::span<double> ranges_m) {
    for (std::size_t i = 0; i < rays.size(); ++i) ranges_m[i] = intersect(rays[i]);
  };
}

TableLoader loader_of(ReadTable read_table) {
  return [read = std::move(read_table)](const std::string& path, const std::string& /*role*/,
                                        const TableColumns& columns) {
    if (!read) throw UsageError("path: " + path + ": the host reads no tables");
    NumberTable table(path, read(path));
    for (const std::string& column : columns.required)
      if (!table.has(column)) table.fail("no column " + column);
    return table;
  };
}

/// Throws UsageError for errors that the host itself must apply: it provides the estimated poses.
void require_no_estimate(const nlohmann::json& config, const std::string& name) {
  const auto refuse_if = [&](bool is_on, const std::string& key) {
    if (is_on) throw UsageError(name + ": " + key + ": the host gives the estimated poses itself");
  };
  const nlohmann::json& navigation = config.at("navigation_error");
  const nlohmann::json& pointing = config.at("pointing_error");
  refuse_if(navigation.contains("table"), "/navigation_error/table");
  refuse_if(navigation.at("attitude") != "truth", "/navigation_error/attitude");
  for (const char* const key : {"time_stamp_bias_s", "time_stamp_sigma_s"})
    refuse_if(pointing.at(key) != 0, std::string("/pointing_error/") + key);
}

ScanModel model_of(const std::string& text, const std::string& name, ReadTable read_table) {
  nlohmann::json config =
      completed_scan_config(resolve_config(parse_json(text, name), embedded_schema("scan")));
  require_no_estimate(config, name);
  if (config.at("noise").at(kIncidenceNoise) != 0)
    throw UsageError(name + ": /noise/" + kIncidenceNoise +
                     ": needs the terrain's surface, which no host gives");
  if (config.at("receiver").at("type") != "none")
    throw UsageError(name + ": /receiver/type: needs the terrain's surface, which no host gives");
  config["trajectory"] = nlohmann::json{{"type", "constant_velocity"}};  // the host moves the lander
  config = resolve_config({name, config}, embedded_schema("scan"));
  return scan_model(config, name, loader_of(std::move(read_table)));
}

void copy_points(const PointColumns& points, std::vector<PixelReturn>& out) {
  out.resize(points.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = {.pixel = points.pixel[i],
              .status = static_cast<Status>(points.status[i]),
              .range_true_m = points.range_true[i],
              .range_measured_m = points.range_measured[i],
              .true_m = {points.x_true[i], points.y_true[i], points.z_true[i]},
              .estimated_m = {points.x_est[i], points.y_est[i], points.z_est[i]}};
}

}  // namespace

struct Instrument::Impl {
  Impl(ScanModel model, IntersectAll intersect)
      : engine(std::move(intersect)),
        pulse_rate_hz(model.pulse_rate_hz),
        navigation_error(std::move(model.navigation_error)),
        aims_from_estimate(model.aims_from_estimate),
        simulator(std::move(model.lidar), &engine, nullptr) {}

  [[nodiscard]] PulseInput input(const Pulse& pulse) const;

  CallbackEngine engine;
  double pulse_rate_hz;
  std::unique_ptr<const NavigationError> navigation_error;
  bool aims_from_estimate;
  PulseSimulator simulator;
};

PulseInput Instrument::Impl::input(const Pulse& pulse) const {
  require(pulse.number >= 0 && pulse.number <= std::numeric_limits<std::int32_t>::max(), {"pulse", "number"},
          static_cast<double>(pulse.number), "in 0..2147483647");
  const double since_start_s =
      pulse.since_start_s.value_or(static_cast<double>(pulse.number) / pulse_rate_hz);
  require_finite({"pulse", "since_start_s"}, since_start_s);
  const Pattern* const pattern = simulator.lidar().pattern.get();
  if (pattern != nullptr && !pattern->compensated() && !pulse.nominal)
    throw UsageError("pulse/nominal: an uncompensated pattern needs it");
  PulseInput input{.time = {pulse.number, since_start_s}, .t_s = since_start_s};
  input.interval_s = 1 / pulse_rate_hz;
  input.truth = pose_of(pulse.truth, "pulse/truth");
  input.estimate = pulse.estimate ? pose_of(*pulse.estimate, "pulse/estimate")
                                  : navigation_error->estimated(input.truth, since_start_s);
  const auto& otherwise = aims_from_estimate ? input.estimate : input.truth;
  input.nominal = pulse.nominal ? pose_of(*pulse.nominal, "pulse/nominal") : otherwise;
  return input;
}

Instrument::Instrument(const std::string& config, Intersect intersect, const std::string& name,
                       ReadTable read_table)
    : Instrument(config, one_by_one(std::move(intersect)), name, std::move(read_table)) {}

Instrument::Instrument(const std::string& config, IntersectAll intersect, const std::string& name,
                       ReadTable read_table)
    : impl_(std::make_unique<const Impl>(model_of(config, name, std::move(read_table)),
                                         std::move(intersect))) {}

Instrument::~Instrument() = default;
Instrument::Instrument(Instrument&&) noexcept = default;
Instrument& Instrument::operator=(Instrument&&) noexcept = default;

double Instrument::pulse_rate_hz() const { return impl_->pulse_rate_hz; }

std::size_t Instrument::pixel_count() const { return impl_->simulator.lidar().detector.pixel_count(); }

std::optional<std::int64_t> Instrument::pulse_limit() const {
  const Pattern* const pattern = impl_->simulator.lidar().pattern.get();
  return pattern != nullptr ? pattern->pulse_limit() : std::nullopt;
}

PulseReturns Instrument::step(const Pulse& pulse) const {
  PulseReturns returns;
  step(pulse, returns);
  return returns;
}

void Instrument::step(const Pulse& pulse, PulseReturns& returns) const {
  PulseBatch batch;
  batch.resize(1, pixel_count());
  PulseWorkspace workspace;
  impl_->simulator.simulate(impl_->input(pulse), 0, batch, workspace);
  returns.angle_1_rad = batch.pulses.angle_1[0];
  returns.angle_2_rad = batch.pulses.angle_2[0];
  copy_points(batch.points, returns.pixels);
}

}  // namespace landfall::lidar
