// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/raster_import.h"

#include <cmath>
#include <filesystem>
#include <string_view>
#include <utility>

#include "app/runs/placed_scene.h"
#include "base/core/error.h"
#include "base/raster/by_rows.h"
#include "chain/terrain/bin_elevations.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/grid_file.h"
#include "store/files/raster_screening.h"
#include "store/files/terrain_file.h"

namespace landfall {
namespace {

/// The true elevations of the bins, and the words of their layer.
struct Truth {
  Grid<double> z;
  std::string comment;
  std::optional<double> spacing_m{};  ///< of its nodes
};

std::string file_name(const std::string& path) { return std::filesystem::path(path).filename().string(); }

Grid<double> values_of(const DemRaster& raster, const RasterGrid& grid) {
  const double scale = grid.dem.vertical_scale.value_or(1);
  auto z = Grid<double>::unset(grid.spec);
  by_rows(grid.spec, [&](std::int64_t row) {
    for (std::int64_t col = 0; col < grid.spec.cols; ++col)
      z.at({row, col}) = scale * interpolate(raster.samples, Interpolation::nearest,
                                             raster.mapping.pixel({grid.spec.x(col), grid.spec.y(row)}));
  });
  return z;
}

/// The DEM of an import and what its truth must fit.
struct ImportedRaster {
  const RasterImport& import;
  const RasterGrid& grid;
  const std::string& crs_wkt;
};

/// Checks the place of a truth; returns where it lies in the DEM's frame.
Placement place_truth(const ImportedRaster& dem, const char* kind, const Sited& truth,
                      std::vector<std::string>& warnings) {
  Meeting meeting = meet(meeting_kind(kind), {dem.import.dem.path, dem.crs_wkt}, truth, dem.import.rules);
  add_said(warnings, truth.name, meeting);
  return std::move(meeting.placement);
}

Truth truth_of_terrain(const ImportedRaster& dem, Provenance& provenance,
                       std::vector<std::string>& warnings) {
  const std::string& path = dem.import.terrain;
  Scene scene = open_scene({.terrain = path, .use = SceneUse::surface});
  provenance.add_input("terrain", scene.file_id, scene.chain);
  const Placement placement = place_truth(dem, "terrain_of_raster", {path, scene.crs_wkt}, warnings);
  require_window(scene, dem.grid.spec, placement);
  scene = placed_scene(std::move(scene), placement);
  return {bin_elevations(*scene.surface, dem.grid.spec), "elevation of the terrain at the bin centre",
          scene.spacing_m};
}

/// sample_raster(); the option that gives a band is not for the truth.
SampledRaster sampled_truth(const DemBase& truth, const RasterGrid& grid, RasterLinks links) {
  try {
    return sample_raster(truth, grid, links);
  } catch (const FormatError& error) {
    if (std::string_view(error.parameter()) != "band") throw;
    throw FormatError(std::string(error.what()) + ", in a file of its own: gdal_translate -b");
  }
}

Truth truth_of_raster(const ImportedRaster& dem, Provenance& provenance, std::vector<std::string>& warnings) {
  const RasterImport& import = dem.import;
  DemBase base{.path = import.truth, .center = {}, .center_pixel = {}, .horizontal_scale_m = {}};
  base.nodata = import.dem.nodata;
  base.keeps_undeclared_fills = import.dem.keeps_undeclared_fills;
  screen_raster(base, import.links);
  SampledRaster sampled = sampled_truth(base, dem.grid, import.links);
  static_cast<void>(place_truth(dem, "truth_of_raster", {import.truth, sampled.crs_wkt}, warnings));
  for (const std::string& sentence : sampled.assumed) warnings.push_back(import.truth + ": " + sentence);
  provenance.add_input("raster", sampled.source_id, nlohmann::json::array(), sampled.assumed);
  return {std::move(sampled.z), "bilinear interpolation of " + file_name(import.truth) +
                                    (sampled.is_reprojected ? ", reprojected by GDAL" : "")};
}

void check_truth(const Grid<double>& z, const Grid<double>& truth, const std::string& name,
                 ImportedDem& result) {
  std::int64_t both = 0;
  std::int64_t filled = 0;
  for (std::size_t i = 0; i < z.values().size(); ++i) {
    if (std::isnan(z.values()[i])) continue;
    ++filled;
    both += std::isnan(truth.values()[i]) ? 0 : 1;
  }
  if (filled > 0 && both == 0)
    throw FormatError(name + ": has no value at any bin of the DEM: is it the truth of another place?");
  result.bins_with_truth = both;
  if (both < filled)
    result.warnings.push_back(name + ": has no value at " + std::to_string(filled - both) + " of " +
                              std::to_string(filled) + " bins with an elevation");
}

void write(LandfallFileWriter& file, const Grid<double>& z, const std::optional<Truth>& truth,
           const std::string& crs_wkt) {
  GridLayerWriter layers(file, z.spec(), crs_wkt);
  layers.write("z_est", z, {.long_name = "elevation", .ancillary_variables = "count"});
  auto count = Grid<std::int32_t>(z.spec());
  for (std::size_t i = 0; i < z.values().size(); ++i) count.values()[i] = std::isnan(z.values()[i]) ? 0 : 1;
  layers.write("count", count, {.long_name = "1 where the raster has a value"});
  if (truth)
    layers.write("z_true", truth->z,
                 {.long_name = "true elevation at the bin centre",
                  .comment = truth->comment,
                  .truth_spacing_m = truth->spacing_m});
  file.commit();
}

nlohmann::json config_of(const RasterImport& import, const RasterGrid& grid, const DemSource& source) {
  nlohmann::json config = {{"source", file_name(import.dem.path)},
                           {"format", source.driver},
                           {"band", source.band},
                           {"center", {grid.center.x, grid.center.y}},
                           {"crs", grid.crs_name.empty() ? nlohmann::json() : nlohmann::json(grid.crs_name)},
                           {"resolution_m", grid.spec.resolution_m}};
  if (!import.dem.crs.empty()) config["given_crs"] = import.dem.crs;
  if (import.dem.vertical_scale) config["vertical_scale"] = *import.dem.vertical_scale;
  if (!import.truth.empty()) config["truth"] = file_name(import.truth);
  return config;
}

}  // namespace

ImportedDem import_raster(const RasterImport& import, ImportOutput output) {
  screen_raster(import.dem, import.links);
  RasterGrid grid = raster_grid(import.dem, import.links);
  grid.same_frame = import.rules.same_frame;
  ImportedDem result{.grid = grid.spec, .center = {grid.center.x, grid.center.y}};
  std::optional<DemRaster> raster;
  Grid<double> z;
  output.phase("read", [&](const ProgressCallback&) {
    raster = dem_loader(import.links)(grid.dem, grid.spec);
    z = values_of(*raster, grid);
  });
  std::vector<std::string> assumed = grid.assumed;
  assumed.insert(assumed.end(), raster->source.assumed.begin(), raster->source.assumed.end());
  for (const std::string& sentence : assumed) result.warnings.push_back(import.dem.path + ": " + sentence);
  output.provenance.config = config_of(import, grid, raster->source);
  output.provenance.add_input("raster", raster_id(*raster), nlohmann::json::array(), std::move(assumed));
  std::optional<Truth> truth;
  output.phase("truth", [&](const ProgressCallback&) {
    const ImportedRaster dem{import, grid, raster->crs_wkt};
    if (!import.terrain.empty())
      truth = truth_of_terrain(dem, output.provenance, result.warnings);
    else if (!import.truth.empty())
      truth = truth_of_raster(dem, output.provenance, result.warnings);
  });
  for (const double value : z.values()) result.empty_bins += std::isnan(value) ? 1 : 0;
  if (result.empty_bins == static_cast<std::int64_t>(z.values().size()))
    throw FormatError(import.dem.path + ": has no pixel with a value");
  if (truth) check_truth(z, truth->z, import.truth.empty() ? import.terrain : import.truth, result);
  LandfallFileWriter file(output.file, "dem", output.provenance);
  output.phase("write", [&](const ProgressCallback&) { write(file, z, truth, raster->crs_wkt); });
  return result;
}

}  // namespace landfall
