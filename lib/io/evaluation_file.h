// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "evaluation/evaluate.h"
#include "io/grid_file.h"
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

/// Writes eval.h5 (SPEC section 8): each layer as the evaluation gives it, /holes and /metrics_json at the
/// end.
class EvaluationWriter : public LayerSink {
 public:
  /// Without a layer the file has no grid either.
  EvaluationWriter(LandfallFileWriter& file, const GridSpec& spec, std::string crs_wkt);

  void take(const CoverageLayers& layers) override;
  void take(Axis axis, const AxisLayers& layers) override;
  void take(const Grid<std::int8_t>& fail) override;

  /// Writes holes and metrics, and commits the file.
  void finish(const Evaluation& evaluation);

 private:
  GridLayerWriter& grid();

  LandfallFileWriter& file_;
  GridSpec spec_;
  std::string crs_wkt_;
  std::optional<GridLayerWriter> grid_;  ///< made for the first layer
};

}  // namespace landfall
