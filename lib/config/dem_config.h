// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "evaluation/parameters.h"
#include "gridding/layers.h"
#include "gridding/method.h"
#include "raster/grid_spec.h"

namespace landfall {

/// regrid.json (docs/user/regrid.md).
struct RegridConfig {
  GridSpec grid;
  TruthAt truth_at = TruthAt::bin_center;
  Method method = Method::bilinear_nearest;
};

[[nodiscard]] RegridConfig regrid_config(const nlohmann::json& resolved, const std::string& name);

/// The layer of an HDF5 file that defines the bins to be judged.
struct RegionMaskSource {
  std::string path;
  std::string layer;
};

/// Returns nothing for the other shapes of region.
[[nodiscard]] std::optional<RegionMaskSource> region_mask_source(const nlohmann::json& resolved);

/// eval.json (docs/user/dem-eval.md). Also throws UsageError for a region that lacks the keys of its shape,
/// or that has those of another shape.
[[nodiscard]] EvaluationParameters evaluation_config(const nlohmann::json& resolved, const std::string& name);

}  // namespace landfall
