// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/error.h"
#include "base/text/parameter_check.h"
#include "chain/lidar/scanner/fsm.h"
#include "chain/lidar/scanner/gimbal.h"
#include "chain/lidar/scanner/palmer.h"
#include "chain/lidar/scanner/polygon.h"
#include "chain/lidar/scanner/risley.h"
#include "chain/lidar/scanner/scanner.h"
#include "chain/lidar/scanner/table_scanner.h"
#include "store/config/json_values.h"
#include "store/config/scan_components.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::unique_ptr<const Scanner> make_flash(const Json&, const ComponentContext&) {
  return std::make_unique<Flash>();
}

MechanismTimingParameters timing_of(const Json& json) {
  return {.turnaround_time_s = json.at("turnaround_time_s").get<double>(),
          .settle_time_s = json.at("settle_time_s").get<double>(),
          .settle_damping = json.at("settle_damping").get<double>(),
          .max_acceleration_radps2 = json.at("max_acceleration_radps2").get<double>()};
}

std::vector<EncoderHarmonic> harmonics_of(const Json& scanner) {
  std::vector<EncoderHarmonic> harmonics;
  for (const Json& json : scanner.at("encoder_harmonics"))
    harmonics.push_back({.axis = json.at("axis").get<int>(),
                         .order = json.at("order").get<int>(),
                         .amplitude_rad = json.at("amplitude_rad").get<double>(),
                         .phase_rad = radians(json, "phase_deg")});
  return harmonics;
}

std::unique_ptr<const Scanner> make_fsm(const Json& json, const ComponentContext& context) {
  return std::make_unique<Fsm>(FsmParameters{.incidence_rad = radians(json, "incidence_deg"),
                                             .fold_azimuth_rad = radians(json, "fold_azimuth_deg"),
                                             .max_deflection_rad = radians(json, "max_deflection_deg"),
                                             .pivot_m = {vector3(json.at("pivot_m"))},
                                             .focal_distance_m = json.at("focal_distance_m").get<double>(),
                                             .encoder_sigma_rad = json.at("encoder_sigma_rad").get<double>(),
                                             .encoder_harmonics = harmonics_of(json),
                                             .timing = timing_of(json),
                                             .tof_lag = json.at("tof_lag").get<bool>(),
                                             .seed = context.seed});
}

std::unique_ptr<const Scanner> make_gimbal(const Json& json, const ComponentContext&) {
  return std::make_unique<Gimbal>(GimbalParameters{.max_deflection_rad = radians(json, "max_deflection_deg"),
                                                   .timing = timing_of(json),
                                                   .encoder_harmonics = harmonics_of(json)});
}

std::unique_ptr<const Scanner> make_polygon(const Json& json, const ComponentContext& context) {
  return std::make_unique<PolygonScanner>(
      PolygonParameters{.facets = json.at("facets").get<int>(),
                        .rate_hz = json.at("rate_hz").get<double>(),
                        .phase_rad = radians(json, "phase_deg"),
                        .line_azimuth_rad = radians(json, "line_azimuth_deg"),
                        .duty_frac = json.at("duty_frac").get<double>(),
                        .frame_amplitude_rad = radians(json, "frame_amplitude_deg"),
                        .frame_rate_hz = json.at("frame_rate_hz").get<double>(),
                        .facet_tilt_rad = json.at("facet_tilt_rad").get<std::vector<double>>(),
                        .facet_tilt_sigma_rad = json.at("facet_tilt_sigma_rad").get<double>(),
                        .facet_tilt_known = json.at("facet_tilt_known").get<bool>(),
                        .encoder_harmonics = harmonics_of(json),
                        .seed = context.seed});
}

std::unique_ptr<const Scanner> make_palmer(const Json& json, const ComponentContext&) {
  return std::make_unique<Palmer>(PalmerParameters{.tilt_rad = radians(json, "tilt_deg"),
                                                   .incidence_rad = radians(json, "incidence_deg"),
                                                   .fold_azimuth_rad = radians(json, "fold_azimuth_deg"),
                                                   .rate_hz = json.at("rate_hz").get<double>(),
                                                   .phase_rad = radians(json, "phase_deg")});
}

/// Returns nothing for a gimbal, which does not accept a mirror's keys.
std::optional<TableMirror> mirror_of(const Json& json) {
  const TableMirror mirror{radians(json, "incidence_deg"), radians(json, "fold_azimuth_deg")};
  if (json.at("mechanism") == "fsm") return mirror;
  for (const char* const key : {"incidence_deg", "fold_azimuth_deg"})
    require(json.at(key) == 0, {"", key}, json.at(key).get<double>(),
            "0, which the mechanism gimbal requires");
  return std::nullopt;
}

std::unique_ptr<const Scanner> make_table_scanner(const Json& json, const ComponentContext& context) {
  const std::optional<TableMirror> mirror = mirror_of(json);
  if (!context.load_table)
    return std::make_unique<TableScanner>(std::vector<AngleSample>{{0, {}}, {1, {}}}, mirror);
  const NumberTable table =
      context.load_table(json.at("path").get<std::string>(), "scanner", angle_columns());
  return std::make_unique<TableScanner>(angle_samples(table), mirror, table.file() + ": scanner table");
}

RisleyOptics risley_optics(const Json& json) {
  using enum RisleyConfiguration;
  RisleyOptics optics{.gap_m = json.at("gap_m").get<double>()};
  const auto index = pair_of(json.at("index"));
  const auto wedge_deg = pair_of(json.at("wedge_deg"));
  const auto thickness_m = pair_of(json.at("thickness_m"));
  for (std::size_t i = 0; i < 2; ++i)
    optics.prisms[i] = {index[i], kRadiansPerDegree * wedge_deg[i], thickness_m[i]};
  const Json& faces = json.at("configuration");
  optics.configuration = faces == "PTTP" ? pttp : faces == "TPPT" ? tppt : faces == "PTPT" ? ptpt : tptp;
  return optics;
}

std::variant<RisleyRotation, RisleyBranch> risley_drive(const Json& json) {
  if (json.contains("pattern")) {
    for (const char* key : {"rates_hz", "phases_deg"})
      if (json.contains(key)) throw UsageError(std::string(key) + ": excludes pattern; give one of them");
    return json.at("branch") == "negative" ? RisleyBranch::negative : RisleyBranch::positive;
  }
  if (json.contains("branch"))
    throw UsageError("branch: needs a pattern; without one the prisms turn at rates_hz");
  const auto phases_deg = pair_of(json.at("phases_deg"));
  return RisleyRotation{pair_of(json.at("rates_hz")),
                        {kRadiansPerDegree * phases_deg[0], kRadiansPerDegree * phases_deg[1]}};
}

std::unique_ptr<const Scanner> make_risley(const Json& json, const ComponentContext& context) {
  return std::make_unique<Risley>(
      RisleyParameters{.optics = risley_optics(json),
                       .drive = risley_drive(json),
                       .encoder_sigma_rad = json.at("encoder_sigma_rad").get<double>(),
                       .seed = context.seed});
}

constexpr ComponentMaker<Scanner> kScanners[] = {
    {"flash", make_flash},          //
    {"fsm", make_fsm},              //
    {"gimbal", make_gimbal},        //
    {"palmer", make_palmer},        //
    {"polygon", make_polygon},      //
    {"risley", make_risley},        //
    {"table", make_table_scanner},  //
};

}  // namespace

std::unique_ptr<const Scanner> make_scanner(const Json& scanner, const ComponentContext& context) {
  return make_component<Scanner>(kScanners, scanner, context);
}

}  // namespace landfall
