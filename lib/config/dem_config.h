// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "evaluation/parameters.h"
#include "gridding/layers.h"
#include "raster/grid_spec.h"

namespace landfall {

/// regrid.json (SPEC section 5).
struct RegridConfig {
  GridSpec grid;
  TruthAt truth_at = TruthAt::bin_center;
};

[[nodiscard]] RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name);

/// eval.json (SPEC section 6).
[[nodiscard]] EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
