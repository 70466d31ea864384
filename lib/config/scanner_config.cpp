// SPDX-License-Identifier: GPL-3.0-or-later
#include "config/json_values.h"
#include "config/scan_components.h"
#include "scanner/flash.h"
#include "scanner/fsm.h"

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

constexpr ComponentMaker<Scanner> kScanners[] = {
    {"flash", make_flash},
    {"fsm", make_fsm},
};

}  // namespace

std::unique_ptr<const Scanner> make_scanner(const Json& scanner, const ComponentContext& context) {
  return make_component<Scanner>(kScanners, scanner, context);
}

}  // namespace landfall
