// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "chain/hazards/hazard_map.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// The map that hazard-map judges: z_est of a DEM or z of a gridded terrain.
struct HazardSource {
  std::string kind;  ///< "dem" or "terrain"
  Grid<double> z;
  std::optional<Grid<double>> z_true;        ///< of a DEM that has it
  std::optional<Grid<double>> z_sigma;       ///< of a DEM that has it: without navigation errors
  std::optional<Grid<double>> noise_sigma;   ///< of a DEM that has both
  std::optional<ReturnCentroids> centroids;  ///< of a DEM that has z_sigma too
  std::optional<double> truth_spacing_m;     ///< DemLayers::truth_spacing_m
  bool is_imported = false;                  ///< is_imported()
  std::string crs_wkt;
  std::string file_id;
  nlohmann::json chain;
};

/// Reads z_true only if requested. Throws FormatError.
[[nodiscard]] HazardSource read_hazard_source(const std::filesystem::path& path, bool with_truth);

/// The places of the true elevations of a DEM: x_true and y_true, the centres of the bins where it lacks
/// them and is made of imported data. Throws FormatError.
struct TruthCentroids {
  Grid<double> x, y;
};
[[nodiscard]] TruthCentroids read_truth_centroids(const std::filesystem::path& path);

/// Writes hazards.h5 (docs/user/files/hazards.md) and commits it.
void write_hazards(LandfallFileWriter& file, const HazardMap& map, const std::string& crs_wkt);

// The parts that hazard_strips.h shares.

/// Throws FormatError for a mesh terrain.
void require_gridded(const LandfallFileReader& file);
[[nodiscard]] Grid<float> single_precision(const Grid<double>& values);
/// The table /sites.
void write_sites(const LandfallFileWriter& file, const HazardMap& map);

/// Sets the positions of sites on the map of their frame.
void place_on_map(std::vector<LandingSite>& sites, const std::string& crs_wkt);

/// A site of sites.json without its rank.
[[nodiscard]] nlohmann::ordered_json site_json(const LandingSite& site);

/// sites.json and score.json (docs/user/files/hazards.md). Unknown numbers are null.
[[nodiscard]] nlohmann::ordered_json sites_json(const HazardMap& map);
[[nodiscard]] nlohmann::ordered_json score_json(const HazardScore& score);

}  // namespace landfall
