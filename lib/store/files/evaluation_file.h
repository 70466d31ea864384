// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "chain/evaluation/evaluate.h"
#include "chain/evaluation/uncertainty.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/files/meeting.h"

namespace landfall {

/// A DEM as dem-eval evaluates it.
struct DemInput {
  DemLayers layers;
  std::string crs_wkt;
  std::string file_id;
  nlohmann::json chain;
  bool has_sigmas = false;  ///< whether read_uncertainty() may find layers
};

/// Reads z_est of a dem.h5 and, if they exist, count and z_true, then also the corrected elevation if
/// it exists, and x_true and y_true if both do. The layer `count` of a DEM that landfall-import made says
/// nothing about returns and is left out. Throws FormatError.
[[nodiscard]] DemInput read_dem(const std::filesystem::path& path, const ProgressCallback& progress = {});

/// Reads parts of a DEM, one at a time.
class DemWindowReader {
 public:
  /// Throws FormatError.
  explicit DemWindowReader(const std::filesystem::path& path);

  /// z_est and, if the DEM has it, truth of bins that lie within its grid. Throws FormatError.
  [[nodiscard]] DemLayers read(const GridSpec& window) const;
  /// The number of returns of every bin; nothing if the DEM has no such layer. Throws FormatError.
  [[nodiscard]] std::optional<Grid<std::int32_t>> count() const;

 private:
  LandfallFileReader file_;
  GridLayerReader layers_;
};

/// The map that a mask is for.
struct MaskedMap {
  std::string name;  ///< for messages
  const GridSpec& grid;
  const std::string& crs_wkt;
  MeetingRules rules = {};
};

/// The bins of a grid whose value in a layer of an HDF5 file is neither 0 nor NaN. The file may be any HDF5
/// file that has the layer in the shape (y, x). Without a frame of its own (/crs), or in the map's frame,
/// coordinates /x and /y, if it has them, must equal the grid's. With another centre on the same map it is
/// moved by whole bins, and bins of the grid beyond it are not in the region. Throws FormatError, also for
/// frames that do not meet (meeting.h).
struct RegionMask {
  BinMask mask;
  std::string file_id;
  std::vector<std::string> said = {};  ///< of the meeting
};
[[nodiscard]] RegionMask read_region_mask(const std::filesystem::path& path, const std::string& layer,
                                          const MaskedMap& map);

/// The error of the map, its sigmas and, if it exists, count of a dem.h5; nothing if one of the
/// first three is missing. Throws FormatError.
[[nodiscard]] std::optional<UncertaintyLayers> read_uncertainty(const std::filesystem::path& path);

/// limit_of_layer() with the limits in the configuration that made an eval.h5; none if it has no valid ones.
[[nodiscard]] std::optional<double> stored_limit(const LandfallFileReader& evaluation,
                                                 const std::string& layer);

/// Writes eval.h5: each layer as the evaluation gives it, /holes, /metrics_json and /verdict_json at the end.
class EvaluationWriter : public LayerSink {
 public:
  /// Without a layer, the file has no grid. Refuses the output as LandfallFileWriter does.
  EvaluationWriter(const OutputOptions& options, const Provenance& provenance, const GridSpec& spec,
                   std::string crs_wkt);

  void take(const CoverageLayers& layers) override;
  void take(Axis axis, const AxisLayers& layers) override;
  void take(const Grid<std::int8_t>& fail) override;

  /// Writes holes, metrics and the sentences of the verdict (verdict_texts()), and commits the file.
  void finish(const Evaluation& evaluation, const EvaluationLimits& limits);

 private:
  GridLayerWriter& grid();

  LandfallFileWriter file_;
  GridSpec spec_;
  std::string crs_wkt_;
  std::optional<GridLayerWriter> grid_;  ///< made for the first layer
};

}  // namespace landfall
