// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/terrain_output.h"

#include <Eigen/Geometry>
#include <memory>
#include <utility>
#include <variant>

#include "base/core/error.h"
#include "base/text/file_path.h"
#include "base/text/number_text.h"
#include "chain/terrain/site_wkt.h"
#include "formats/gdal/gdal_loader.h"
#include "formats/mesh/mesh_file.h"
#include "store/files/mesh_terrain_file.h"
#include "store/files/raster_screening.h"

namespace landfall {
namespace {

enum class TerrainFormat { landfall, geotiff, mesh };

TerrainFormat terrain_format(const std::filesystem::path& output) {
  const std::string extension = file_extension(output);
  if (extension == ".h5" || extension == ".nc") return TerrainFormat::landfall;
  if (extension == ".tif" || extension == ".tiff") return TerrainFormat::geotiff;
  if (extension == ".obj" || extension == ".ply") return TerrainFormat::mesh;
  throw UsageError("output " + output.string() + ": extension '" + extension +
                   "' is not one of .h5 and .nc (terrain), .tif and .tiff (GeoTIFF), .obj and .ply (mesh)");
}

/// The origin of an exported terrain.
struct Origin {
  const std::string& crs_wkt;
  const std::string& file_id;
};

/// Writes a terrain in another format than .h5.
void write_export(const TerrainOutput& output, const TriangulatedGrid& grid, const Origin& origin) {
  output.phase("write", [&](const ProgressCallback& progress) {
    if (terrain_format(output.file.path) == TerrainFormat::mesh)
      return write_mesh_file(output.file, grid, progress);
    const std::string software = source_line(output.provenance.tool);
    write_geotiff(output.file, {{{&grid.nodes()}}, origin.crs_wkt, software, origin.file_id}, progress);
  });
}

void write_export(const TerrainOutput& output, const IndexedTriangles& mesh) {
  if (terrain_format(output.file.path) == TerrainFormat::geotiff)
    throw UsageError("output " + output.file.path.string() +
                     ": a mesh cannot be written as GeoTIFF; use .obj or .ply");
  output.phase("write",
               [&](const ProgressCallback& progress) { write_mesh_file(output.file, mesh, progress); });
}

/// Writes terrain.h5 through write(file).
template <class Write>
void write_own(const TerrainOutput& output, const Write& write) {
  LandfallFileWriter file(output.file, "terrain", output.provenance);
  output.phase("write", [&](const ProgressCallback&) { write(file); });
}

using Warn = std::function<void(const std::string&)>;

/// Warnings about the axes of a mesh file, and about how the placed mesh stands.
std::vector<std::string> place_findings(const MeshImport& import, const PlaceComments& comments,
                                        const IndexedTriangles& mesh) {
  constexpr std::size_t kFewestVertices = 16;  // that show a shape
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& vertex : mesh.vertices) box.extend(vertex);
  const Eigen::Vector3d size = box.sizes();
  const bool on_edge =
      mesh.vertices.size() >= kFewestVertices && stands_on_edge({size.x(), size.y(), size.z()});
  const RollPitchYaw& turn = import.placement.rotate;
  const bool is_turned = turn.roll_rad != 0 || turn.pitch_rad != 0;
  return place_warnings(comments, on_edge, import.up_is_given || is_turned, ": mesh.translate_m can add it");
}

CleanMesh read_clean_mesh(const MeshImport& import, Provenance& provenance, const Warn& warn,
                          const ProgressCallback& progress) {
  MeshFile read = read_mesh_file(import.path);
  report(progress, 0.5);
  provenance.add_input("mesh", read.content_id, {});
  for (const std::string& unread : read.soup.unread) warn(import.path + ": " + unread + " is not read");
  CleanMesh mesh = clean_mesh(std::move(read.soup), import.placement, import.path);
  for (const std::string& finding : place_findings(import, read.comments, mesh.mesh))
    warn(import.path + ": " + finding);
  report(progress, 1);
  return mesh;
}

TerrainContent build_mesh(const MeshImport& import, TerrainOutput& output) {
  if (file_extension(output.file.path) == ".nc")
    throw UsageError("output " + output.file.path.string() +
                     ": .nc is for grids; a mesh is written as .h5, .obj or .ply");
  TerrainContent content;
  const IndexedTriangles& mesh = content.mesh.emplace().mesh;
  output.phase("mesh", [&](const ProgressCallback& progress) {
    const auto warn = [&](const std::string& text) { content.warnings.push_back(text); };
    content.mesh = read_clean_mesh(import, output.provenance, warn, progress);
  });
  require_sound(mesh, import.path);
  if (terrain_format(output.file.path) == TerrainFormat::landfall)
    write_own(output, [&](LandfallFileWriter& file) { write_mesh_terrain(file, mesh); });
  else
    write_export(output, mesh);
  return content;
}

/// Warnings of a site that is much smaller than a pixel of its raster, or much finer.
std::vector<std::string> posting_warnings(const DemBase& dem, const DemRaster& raster, const GridSpec& site) {
  const double posting_m = raster.mapping.posting_m();
  const double width_m = static_cast<double>(site.cols - 1) * site.resolution_m;
  const std::string subject = dem.path + ": the raster has one sample per " + short_number(posting_m) + " m";
  constexpr double kSlack = 1 + 1e-9;  // of the posting, which is the inverse of a matrix
  if (posting_m > kSlack * width_m / 4)
    return {subject + ", the site is only " + short_number(width_m) + " m wide: its values are interpolated"};
  if (site.resolution_m < posting_m / 1000)
    return {subject + ", the grid one node per " + short_number(site.resolution_m) +
            " m: that is more than 1,000 times finer"};
  return {};
}

/// Brings further rasters of a terrain to the site of the first: the same centre on the same map.
class RasterPlaces {
 public:
  RasterPlaces(const RasterRules& rules, Warn warn) : rules_(rules), warn_(std::move(warn)) {}

  /// The raster around the first one's centre. Throws FormatError for one that does not meet the first.
  [[nodiscard]] DemBase placed(DemBase dem) {
    const Sited own{dem.path, raster_site(dem, rules_.links)};
    if (!first_) first_ = own;
    const Meeting meeting = meet(meeting_kind("base_rasters"), *first_, own, rules_.meeting);
    const std::array<double, 3>& shift_m = meeting.placement.shift_m();
    if (shift_m[0] == 0 && shift_m[1] == 0) return dem;
    const std::optional<MapPlace> site = place_of(first_->crs_wkt);
    dem.center_pixel.reset();
    dem.center = {site->center[0] * site->metres_per_unit, site->center[1] * site->metres_per_unit};
    for (double& coordinate : *dem.center) coordinate /= place_of(own.crs_wkt)->metres_per_unit;
    std::vector<std::string> lines;
    add_said(lines, dem.path, meeting);
    for (const std::string& line : lines) warn_(line);
    return dem;
  }

 private:
  RasterRules rules_;
  Warn warn_;
  std::optional<Sited> first_;
};

/// Loads rasters, and records and reports findings about them.
DemLoader recording_dem_loader(const RasterRules& rules, Provenance& provenance, const Warn& warn) {
  const auto places = std::make_shared<RasterPlaces>(rules, warn);
  return [links = rules.links, places, &provenance, warn](const DemBase& asked, const GridSpec& site) {
    screen_raster(asked, links);
    const DemBase dem = places->placed(asked);
    DemRaster raster = dem_loader(links)(dem, site);
    provenance.add_input("raster", raster_id(raster), {}, raster.source.assumed);
    for (const std::string& assumed : raster.source.assumed) warn(dem.path + ": " + assumed);
    for (const std::string& warning : posting_warnings(dem, raster, site)) warn(warning);
    return raster;
  };
}

/// The albedo of a terrain in memory.
std::shared_ptr<const SurfaceAlbedo> albedo_map(Grid<float> albedo) {
  const GridSpec spec = albedo.spec();
  return std::make_shared<const AlbedoMap>(spec, BinIndex{spec.rows, spec.cols},
                                           [albedo = std::move(albedo)](const GridSpec&) { return albedo; });
}

std::map<std::string, std::int64_t> count_by_kind(const std::vector<PlacedFeature>& features) {
  std::map<std::string, std::int64_t> counts;
  for (const PlacedFeature& placed : features) ++counts[feature_kinds()[placed.feature.shape.index()]];
  return counts;
}

/// Builds a terrain that is never in memory as a whole.
TerrainContent build_in_strips(const TerrainConfig& config, const DemLoader& load,
                               const TerrainOutput& output) {
  std::optional<TerrainStrips> strips;
  output.phase("long waves", [&](const ProgressCallback& progress) {
    strips.emplace(config.model, config.grid, load, StripSize(), progress);
  });
  LandfallFileWriter file(output.file, "terrain", output.provenance);
  TerrainContent content;
  output.phase("terrain", [&](const ProgressCallback& progress) {
    content.nodes = write_terrain(file, *strips, progress);
  });
  content.features_of = count_by_kind(strips->features());
  return content;
}

}  // namespace

SiteSize fit_site_of(const DemBase& dem, const SiteRequest& request, RasterLinks links) {
  screen_raster(dem, links);
  return fit_dem_site(dem, request, links);
}

std::vector<std::string> input_files(const TerrainConfig& config, const std::filesystem::path& path,
                                     RasterLinks links) {
  if (config.mesh) return {config.mesh->path};
  std::vector<std::string> files;
  const bool replaces = std::filesystem::exists(status_of(path));
  const auto add = [&](const DemBase& dem) {
    files.push_back(dem.path);
    if (!replaces) return;
    screen_raster(dem, links);
    for (std::string& file : dem_files(dem, links)) files.push_back(std::move(file));
  };
  for (const Base& base : config.model.bases)
    if (const auto* const dem = std::get_if<DemBase>(&base)) add(*dem);
  if (config.model.albedo)
    if (const auto* const map = std::get_if<AlbedoRaster>(&config.model.albedo->ground)) add(map->raster);
  return files;
}

TerrainContent build_terrain(const TerrainConfig& config, const RasterRules& rules, TerrainOutput output) {
  const bool is_own = terrain_format(output.file.path) == TerrainFormat::landfall;
  if (config.mesh) return build_mesh(*config.mesh, output);
  std::vector<std::string> warnings;
  if (config.model.albedo && !is_own)
    warnings.push_back("/albedo has no effect: only a .h5 or .nc terrain has that layer");
  const DemLoader load = recording_dem_loader(
      rules, output.provenance, [&](const std::string& warning) { warnings.push_back(warning); });
  if (is_own && config.grid.rows * config.grid.cols > StripSize().max_nodes) {
    TerrainContent content = build_in_strips(config, load, output);
    content.warnings = std::move(warnings);
    return content;
  }
  GeneratedTerrain terrain;
  output.phase("terrain", [&](const ProgressCallback& progress) {
    terrain = generate_terrain(config.model, config.grid, load, progress);
  });
  TerrainContent content{
      count_nodes(terrain.nodes), count_by_kind(terrain.features), {}, std::move(warnings)};
  if (is_own) {
    write_own(output, [&](LandfallFileWriter& file) { write_terrain(file, terrain); });
  } else {
    write_export(output, TriangulatedGrid(std::move(terrain.nodes)),
                 {terrain.crs_wkt, output.provenance.file_id()});
  }
  return content;
}

TerrainInput make_terrain(const TerrainConfig& config, const MeetingRules& rules, Provenance& provenance,
                          const Warn& warn) {
  TerrainInput made;
  if (config.mesh) {
    CleanMesh read = read_clean_mesh(*config.mesh, provenance, warn, {});
    made.crs_wkt = kLocalSiteCrsWkt;
    made.mesh = std::make_shared<const TriangleMesh>(std::move(read.mesh), config.mesh->path);
    made.surface = made.mesh;
    return made;
  }
  GeneratedTerrain terrain =
      generate_terrain(config.model, config.grid, recording_dem_loader({.meeting = rules}, provenance, warn));
  made.crs_wkt = std::move(terrain.crs_wkt);
  if (terrain.albedo) made.albedo = albedo_map(*std::move(terrain.albedo));
  made.grid = std::make_shared<const TriangulatedGrid>(std::move(terrain.nodes));
  made.surface = made.grid;
  return made;
}

TerrainContent export_terrain(const std::string& path, const TerrainOutput& output) {
  if (terrain_format(output.file.path) == TerrainFormat::landfall)
    throw UsageError("--from " + path + " is a terrain.h5 already; name a .tif, .obj or .ply output");
  TerrainInput terrain;
  output.phase("read", [&](const ProgressCallback& progress) { terrain = read_terrain(path, progress); });
  if (terrain.mesh) {
    write_export(output, terrain.mesh->data());
    return {};
  }
  try {
    write_export(output, *terrain.grid, {terrain.crs_wkt, terrain.file_id});
  } catch (const FormatError& error) {
    throw FormatError(path + ": " + error.what());
  }
  return {count_nodes(terrain.grid->nodes())};
}

}  // namespace landfall
