// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "base/raster/grid_spec.h"
#include "chain/evaluation/parameters.h"
#include "chain/gridding/layers.h"
#include "chain/gridding/method.h"

namespace landfall {

/// regrid.json (docs/user/regrid.md).
struct RegridConfig {
  GridSpec grid;
  TruthAt truth_at = TruthAt::bin_center;
  Method method = Method::bilinear_nearest;
};

[[nodiscard]] RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name);

/// eval.json (docs/user/dem-eval.md). Also throws UsageError as region_config() does.
[[nodiscard]] EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
