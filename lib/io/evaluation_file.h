// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "evaluation/evaluate.h"
#include "io/landfall_file.h"

namespace landfall {

/// A DEM as dem-eval judges it.
struct DemInput {
  DemLayers layers;
  std::string crs_wkt;
  std::string file_id;
  nlohmann::json chain;
};

/// Reads z_est and, where all three are there, x_true, y_true and z_true of a dem.h5. Throws FormatError.
[[nodiscard]] DemInput read_dem(const std::filesystem::path& path);

/// Writes eval.h5: the layers that the evaluation kept, /holes and /metrics_json (SPEC section 8).
void write_evaluation(LandfallFileWriter& file, const GridSpec& spec, const std::string& crs_wkt,
                      const Evaluation& evaluation);

}  // namespace landfall
