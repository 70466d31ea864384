// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chain/hazards/strip_map.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// The layers that hazard-map can write without having them in memory.
[[nodiscard]] const std::vector<std::string>& strip_layer_names();

/// Throws UsageError for a name that is not one of them, and for one given twice.
void check_strip_layers(const std::vector<std::string>& layers);

/// The map that hazard-map judges, z_est of a DEM or z of a gridded terrain, of which only the rows in use
/// are loaded; keeps the file open.
class HazardStripReader {
 public:
  /// Throws FormatError.
  explicit HazardStripReader(const std::filesystem::path& path);

  [[nodiscard]] const std::string& kind() const { return kind_; }  ///< "dem" or "terrain"
  [[nodiscard]] const std::string& crs_wkt() const { return layers_.crs_wkt(); }
  [[nodiscard]] const std::string& file_id() const { return file_.file_id(); }
  [[nodiscard]] const nlohmann::json& chain() const { return file_.chain(); }
  [[nodiscard]] bool has_sigma() const;
  /// Loads whole rows of tiles, and keeps those that consecutive requests have in common.
  /// Throws FormatError for an infinite elevation. Refers to this reader.
  [[nodiscard]] StripSource source();

 private:
  [[nodiscard]] Grid<double> load(const GridSpec& rows);
  const Grid<double>& tile_row(std::int64_t number);

  LandfallFileReader file_;
  GridLayerReader layers_;
  std::string kind_;
  std::string layer_;
  std::map<std::int64_t, Grid<double>> tile_rows_;
};

/// Writes hazards.h5 with some of its layers, strip by strip.
class HazardStripWriter {
 public:
  /// `layers` are of strip_layer_names().
  HazardStripWriter(LandfallFileWriter& file, const GridSpec& spec, const std::string& crs_wkt,
                    std::vector<std::string> layers);

  void take(const PlaceMeasures& strip);
  /// Writes the final attributes, and commits the file.
  void finish(const HazardMap& map);

 private:
  struct Layer {
    h5::Handle dataset;
    ValueRange range;
  };
  [[nodiscard]] bool has(const std::string& name) const;
  void take(const std::string& name, const Grid<double>& values);

  LandfallFileWriter& file_;
  GridLayerWriter out_;
  std::vector<std::string> names_;
  std::map<std::string, Layer> layers_;
};

}  // namespace landfall
