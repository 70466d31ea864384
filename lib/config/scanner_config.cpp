// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/error.h"
#include "config/json_values.h"
#include "config/scan_components.h"
#include "scanner/flash.h"
#include "scanner/fsm.h"
#include "scanner/risley.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

std::unique_ptr<const Scanner> make_flash(const Json&, const ComponentContext&) {
  return std::make_unique<Flash>();
}

std::unique_ptr<const Scanner> make_fsm(const Json& json, const ComponentContext&) {
  return std::make_unique<Fsm>(FsmParameters{.incidence_rad = radians(json, "incidence_deg"),
                                             .fold_azimuth_rad = radians(json, "fold_azimuth_deg"),
                                             .max_deflection_rad = radians(json, "max_deflection_deg")});
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
      if (json.contains(key))
        throw UsageError(std::string("scanner: ") + key + " and pattern exclude each other");
    return json.at("branch") == "negative" ? RisleyBranch::negative : RisleyBranch::positive;
  }
  if (json.contains("branch"))
    throw UsageError("scanner: branch needs a pattern; without one the prisms turn at rates_hz");
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
    {"flash", make_flash},    //
    {"fsm", make_fsm},        //
    {"risley", make_risley},  //
};

}  // namespace

std::unique_ptr<const Scanner> make_scanner(const Json& scanner, const ComponentContext& context) {
  return make_component<Scanner>(kScanners, scanner, context);
}

}  // namespace landfall
