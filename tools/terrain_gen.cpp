// SPDX-License-Identifier: GPL-3.0-or-later
// terrain-gen: builds the true terrain of a landing site, or exports one.
#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <optional>
#include <variant>

#include "cli/tool.h"
#include "config/import_config.h"
#include "config/terrain_config.h"
#include "exports/terrain_export.h"
#include "files/mesh_terrain_file.h"
#include "files/raster_screening.h"
#include "files/terrain_file.h"
#include "meshio/mesh_file.h"
#include "terrain/gdal/gdal_loader.h"
#include "terrain/relief/terrain_generator.h"
#include "terrain/relief/terrain_strips.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  terrain-gen -c terrain.json -o terrain.h5
  terrain-gen -o slope.h5 --set base.slope_x=0.1 \
    --set 'features=[{"type":"cone","radius_m":3,"height_m":10}]'
  terrain-gen --from europa.tif -o europa.h5 --center 3800,3380 --half-width 60 --resolution 0.05
  terrain-gen --from apollo15.png -o apollo.h5 --horizontal-scale 2 --vertical-scale 0.192
  terrain-gen --from itokawa.obj -o itokawa.h5 --set mesh.scale_m=1000
  terrain-gen --from europa.h5 -o europa.tif
By the output's extension: .h5 terrain, .tif (.tiff) cloud-optimized GeoTIFF, .obj or .ply mesh.
Configuration: --print-schema, man terrain-gen, docs/user/terrain-gen.md.)";

constexpr const char* kDescription =
    R"(Writes the terrain that scan-sim scans and regrid compares with: elevations on a regular grid, or a triangle mesh.

The relief is a plane, fractal ground, an imported raster, or a sum of these; features (cones, rocks, craters, ice blocks, ridges, fractures, pits, penitentes) are placed one by one, in patterns, or as populations drawn from a size distribution. Lengths are metres in the site's frame, z upwards, the origin at the intended landing site.

--from imports a raster that GDAL reads or a mesh (OBJ, PLY, OFF, STL), or exports a terrain.h5. The same configuration and seed give the same bytes on any machine with any number of threads.)";

struct Options {
  ImportOptions import;
  bool follow_links = false;

  [[nodiscard]] RasterLinks links() const {
    return follow_links ? RasterLinks::followed : RasterLinks::refused;
  }
};

void bind_links(CLI::App& app, bool& follow_links) {
  app.add_flag("--follow-links", follow_links,
               "Open the files on this machine that a raster names, such as a VRT's sources");
}

void bind(CLI::App& app, ImportOptions& import) {
  CLI::Option* const from =
      app.add_option("--from", import.from, "Raster or mesh to import, or terrain.h5 to export")
          ->type_name("FILE");
  const auto of_raster = [&](const char* name, std::string& text, const char* type, const char* meaning) {
    return app.add_option(name, text, meaning)->type_name(type)->needs(from);
  };
  CLI::Option* const center =
      of_raster("--center", import.center, "X,Y", "Site centre in the raster's CRS; default: its middle");
  of_raster("--center-pixel", import.center_pixel, "COLUMN,ROW", "Site centre as a pixel")->excludes(center);
  of_raster("--band", import.band, "N", "Band of the raster, from 1");
  of_raster("--interpolation", import.interpolation, "METHOD", "nearest, bilinear or bicubic (default)");
  of_raster("--datum", import.datum, "DATUM", "z = 0 is the centre's elevation (center, default), or none");
  of_raster("--vertical-scale", import.vertical_scale, "FACTOR", "Metres per unit of the elevations");
  of_raster("--horizontal-scale", import.horizontal_scale, "M",
            "Metres per unit of the coordinates (per pixel), for a raster without a CRS");
  app.add_option("--half-width", import.half_width,
                 "grid.half_width_m; with --from by default the largest that fits")
      ->type_name("M");
  app.add_option("--resolution", import.resolution,
                 "grid.resolution_m; with --from by default the raster's own")
      ->type_name("M");
}

/// --from names a terrain, which is exported as it is.
bool is_export(const ImportOptions& import) { return !import.from.empty() && is_landfall_file(import.from); }

/// Throws UsageError for an option that has no part in an export.
void require_plain_export(const ImportOptions& import, const cli::CommonOptions& common) {
  ImportOptions only_from;
  only_from.from = import.from;
  const bool configured =
      !common.config_path.empty() || !common.assignments.empty() || common.seed || common.print_config;
  if (configured || !(import == only_from))
    throw UsageError("--from " + import.from +
                     ": a landfall file is exported as it is, without configuration; to cut or interpolate a "
                     "terrain, name its layer as a raster: NETCDF:\"" +
                     import.from + "\":z");
}

void expand(JsonSource& source, const ImportOptions& import, const cli::CommonOptions& common) {
  if (is_export(import))
    require_plain_export(import, common);
  else
    apply_import(source, import);
}

void complete(JsonSource& source, const Options& options) {
  const auto fit = [&](const DemBase& dem, const SiteRequest& request) {
    screen_raster(dem, options.links());
    return fit_dem_site(dem, request, options.links());
  };
  if (!options.import.from.empty() && !is_export(options.import))
    complete_import(source, options.import, fit);
}

void check(const cli::Session& session, const ImportOptions& import) {
  if (is_export(import))
    static_cast<void>(LandfallFileReader(import.from, {"terrain"}));
  else
    static_cast<void>(terrain_config(session.config(), session.config_name()));
}

/// The files of the rasters that `output` must not replace; what they consist of is asked only where there is
/// a file to replace.
std::vector<std::string> raster_paths(const TerrainModel& model, const std::string& output,
                                      RasterLinks links) {
  std::vector<std::string> paths;
  std::error_code unreachable;
  const bool replaces = std::filesystem::exists(output, unreachable);
  for (const Base& base : model.bases) {
    const auto* const dem = std::get_if<DemBase>(&base);
    if (dem == nullptr) continue;
    paths.push_back(dem->path);
    if (!replaces) continue;
    screen_raster(*dem, links);
    for (std::string& file : dem_files(*dem, links)) paths.push_back(std::move(file));
  }
  return paths;
}

void count_holes(cli::Session& session, const Grid<double>& nodes) {
  std::int64_t holes = 0;
  for (const double z : nodes.values()) holes += std::isnan(z) ? 1 : 0;
  session.count("node_count", nodes.spec().size());
  session.count("hole_node_count", holes);
}

void count_features(cli::Session& session, const std::vector<PlacedFeature>& features) {
  std::vector<std::int64_t> counts(feature_kinds().size());
  for (const PlacedFeature& placed : features) ++counts[placed.feature.shape.index()];
  nlohmann::json by_kind = nlohmann::json::object();
  for (std::size_t kind = 0; kind < counts.size(); ++kind)
    if (counts[kind] > 0) by_kind[feature_kinds()[kind]] = counts[kind];
  session.count("feature_count", features.size());
  session.count("feature_count_by_kind", std::move(by_kind));
}

/// What an export says about where it comes from.
struct ExportOrigin {
  const std::string& crs_wkt;
  const std::string& file_id;
};

/// Writes a terrain in another format than its own; `grid` is null for a mesh.
void write_export(cli::Session& session, const OutputOptions& output, const TerrainSurface& surface,
                  const TriangulatedGrid* grid, const ExportOrigin& origin) {
  const bool geotiff = terrain_format(output.path) == TerrainFormat::geotiff;
  if (geotiff && grid == nullptr)
    throw UsageError("output " + output.path.string() +
                     ": a mesh has no grid to write as GeoTIFF; .obj and .ply hold it");
  session.phase("write", [&](const ProgressCallback& progress) {
    if (geotiff)
      write_geotiff(output, {{{&grid->nodes()}}, origin.crs_wkt, source_line(session.tool()), origin.file_id},
                    progress);
    else
      write_mesh_file(output, surface, progress);
  });
}

ExitCode export_terrain(cli::Session& session, const std::string& path) {
  const OutputOptions output = session.output({path});
  if (terrain_format(output.path) == TerrainFormat::landfall)
    throw UsageError("--from " + path + " is a terrain.h5 already; name a .tif, .obj or .ply output");
  TerrainInput terrain;
  session.phase("read", [&](const ProgressCallback& progress) { terrain = read_terrain(path, progress); });
  write_export(session, output, *terrain.surface, terrain.grid.get(), {terrain.crs_wkt, terrain.file_id});
  if (terrain.grid) count_holes(session, terrain.grid->nodes());
  return ExitCode::done;
}

void count_mesh(cli::Session& session, const CleanMesh& mesh) {
  session.count("vertex_count", mesh.mesh.vertices.size());
  session.count("triangle_count", mesh.mesh.triangles.size());
  session.count("welded_vertex_count", mesh.welded_vertex_count);
  session.count("unreferenced_vertex_count", mesh.unreferenced_vertex_count);
  session.count("degenerate_facet_count", mesh.degenerate_facet_count);
}

ExitCode run_mesh(cli::Session& session, const MeshImport& import) {
  const OutputOptions output = session.output({import.path});
  Provenance provenance = session.provenance();
  CleanMesh mesh;
  session.phase("mesh", [&](const ProgressCallback& progress) {
    MeshFile read = read_mesh_file(import.path);
    report(progress, 0.5);
    provenance.add_input("mesh", read.content_id, nlohmann::json::array());
    mesh = clean_mesh(std::move(read.soup), import.placement, import.path);
    report(progress, 1);
  });
  if (terrain_format(output.path) == TerrainFormat::landfall) {
    LandfallFileWriter file(output, "terrain", provenance);
    session.phase("write", [&](const ProgressCallback&) { write_mesh_terrain(file, mesh.mesh); });
  } else {
    const TriangleMesh surface(mesh.mesh, import.path);
    write_export(session, output, surface, nullptr, {kLocalSiteCrsWkt, provenance.file_id()});
  }
  count_mesh(session, mesh);
  return ExitCode::done;
}

void write_generated(cli::Session& session, const OutputOptions& output, const Provenance& provenance,
                     GeneratedTerrain terrain) {
  if (terrain_format(output.path) == TerrainFormat::landfall) {
    LandfallFileWriter file(output, "terrain", provenance);
    session.phase("write", [&](const ProgressCallback&) { write_terrain(file, terrain); });
    return;
  }
  const TriangulatedGrid grid(std::move(terrain.nodes));
  write_export(session, output, grid, &grid, {terrain.crs_wkt, provenance.file_id()});
}

bool is_large(const GridSpec& grid) { return grid.rows * grid.cols > StripSize().most_nodes; }

/// A terrain that is never in memory as a whole.
ExitCode run_in_strips(cli::Session& session, const TerrainConfig& config, const OutputOptions& output,
                       const Provenance& provenance, const DemLoader& load) {
  std::optional<TerrainStrips> strips;
  session.phase("long waves", [&](const ProgressCallback& progress) {
    strips.emplace(config.model, config.grid, load, StripSize(), progress);
  });
  LandfallFileWriter file(output, "terrain", provenance);
  session.phase("terrain", [&](const ProgressCallback& progress) {
    const WrittenNodes written = write_terrain(file, *strips, progress);
    session.count("node_count", written.count);
    session.count("hole_node_count", written.holes);
  });
  count_features(session, strips->features());
  return ExitCode::done;
}

ExitCode generate(cli::Session& session, RasterLinks links) {
  const TerrainConfig config = terrain_config(session.config(), session.config_name());
  if (config.mesh) return run_mesh(session, *config.mesh);
  const OutputOptions output =
      session.output(raster_paths(config.model, session.options().output_path, links));
  const TerrainFormat format = terrain_format(output.path);
  Provenance provenance = session.provenance();
  const DemLoader load = [&](const DemBase& dem, const GridSpec& site) {
    screen_raster(dem, links);
    DemRaster raster = dem_loader(links)(dem, site);
    provenance.add_input("raster", raster_id(raster), nlohmann::json::array());
    return raster;
  };
  if (format == TerrainFormat::landfall && is_large(config.grid))
    return run_in_strips(session, config, output, provenance, load);
  GeneratedTerrain terrain;
  session.phase("terrain", [&](const ProgressCallback& progress) {
    terrain = generate_terrain(config.model, config.grid, load, progress);
  });
  count_holes(session, terrain.nodes);
  count_features(session, terrain.features);
  write_generated(session, output, provenance, std::move(terrain));
  return ExitCode::done;
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  ImportOptions& import = options.import;
  cli::Tool tool;
  tool.name = "terrain-gen";
  tool.summary = "Builds the true terrain of a landing site: relief, features, imported rasters and meshes.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.schema = "terrain";
  tool.has_seed = true;
  tool.bind = [&](CLI::App& app) {
    bind(app, import);
    bind_links(app, options.follow_links);
  };
  tool.expand = [&](JsonSource& source, const cli::CommonOptions& common) { expand(source, import, common); };
  tool.complete = [&](JsonSource& source) { complete(source, options); };
  tool.check = [&](const cli::Session& session) { check(session, import); };
  tool.run = [&](cli::Session& session) {
    return is_export(import) ? export_terrain(session, import.from) : generate(session, options.links());
  };
  return cli::tool_main(argc, argv, tool);
}
