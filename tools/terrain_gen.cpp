// SPDX-License-Identifier: GPL-3.0-or-later
// terrain-gen: builds the true terrain of a landing site, or exports one.
#include <CLI/CLI.hpp>
#include <utility>
#include <vector>

#include "app/cli/meeting_options.h"
#include "app/cli/outcomes.h"
#include "app/cli/tool.h"
#include "app/exports/terrain_output.h"
#include "store/config/import_config.h"
#include "store/config/terrain_config.h"
#include "store/files/current_output.h"
#include "tools.h"

namespace landfall::terrain_gen {
namespace {

constexpr const char* kExamples = R"(Examples:
  terrain-gen -c terrain.json -o terrain.h5
  terrain-gen -o slope.h5 --set base.slope_x=0.1 \
    --set 'features=[{"type":"cone","radius_m":3,"height_m":10}]'
  terrain-gen --from europa.tif -o europa.h5 --center 3800,3380 \
    --half-width 60 --resolution 0.05
  terrain-gen --from apollo15.png -o apollo.h5 \
    --horizontal-scale 2 --vertical-scale 0.192
  terrain-gen --from itokawa.obj -o itokawa.h5 --set mesh.scale_m=1000
  terrain-gen --from europa.h5 -o europa.tif
The extension of the output selects the format: .h5 terrain, .tif (.tiff)
cloud-optimized GeoTIFF, .obj or .ply mesh.
Configuration: --print-schema, man terrain-gen, docs/user/terrain-gen.md.)";

constexpr const char* kDescription =
    R"(Writes the terrain that scan-sim scans and regrid compares with: elevations on a regular grid, or a triangle mesh.

The relief is a plane, fractal terrain, an imported raster, or a sum of these; features (cones, rocks, craters, ice blocks, ridges, fractures, pits, penitentes) are placed individually, in patterns, or as populations drawn from a size distribution. Lengths are in metres in the site frame, z upwards, the origin at the intended landing site.

--from imports a raster that GDAL reads or a mesh (OBJ, PLY, OFF, STL, .tab), or exports a terrain.h5. The same configuration and seed give the same bytes on any machine with any number of threads.)";

struct Options {
  ImportOptions import;
  RasterLinks links = RasterLinks::refused;
  MeetingRules rules;
};

void bind(CLI::App& app, Options& o) {
  ImportOptions& import = o.import;
  CLI::Option* const from =
      app.add_option("--from", import.from, "Raster or mesh to import, or terrain.h5 to export")
          ->type_name("FILE");
  const auto of_raster = [&](const char* name, std::string& text, const char* type, const char* meaning) {
    return app.add_option(name, text, meaning)->type_name(type)->needs(from);
  };
  CLI::Option* const center =
      of_raster("--center", import.center, "X,Y",
                "Site centre in the CRS of the raster; default: the middle of the raster");
  of_raster("--center-pixel", import.center_pixel, "COLUMN,ROW", "Site centre in pixels")->excludes(center);
  of_raster("--band", import.band, "N",
            "Band number; default: the first, unless it is a colour, which only a given number accepts");
  of_raster("--interpolation", import.interpolation, "METHOD",
            "Interpolation: nearest, bilinear or bicubic (default)");
  of_raster("--datum", import.datum, "DATUM",
            "Zero elevation: center (elevation at the site centre, default) or none (that of the raster)");
  of_raster("--vertical-scale", import.vertical_scale, "FACTOR",
            "Metres per unit of the elevations; default: the unit that the raster declares, else 1");
  of_raster(
      "--horizontal-scale", import.horizontal_scale, "M",
      "Metres per unit of the coordinates (per pixel without a georeference), for a raster without a CRS");
  of_raster("--crs", import.crs, "DEF",
            "CRS that replaces that of the raster: EPSG:NUMBER, a PROJ text or WKT");
  of_raster(
      "--nodata", import.nodata, "VALUE[,...]",
      "Samples that are holes, in addition to those that the raster declares; none: keep numbers that look "
      "like undeclared fill values");
  app.add_option("--half-width", import.half_width,
                 "Half width of the site, metres; default with --from: the largest that fits")
      ->type_name("M");
  app.add_option("--resolution", import.resolution,
                 "Node distance, metres; default with --from: that of the raster")
      ->type_name("M");
  app.add_option("--up", import.up,
                 "Axis of a mesh file that points up: z (default), or y, which turns (x, y, z) to (x, -z, y)")
      ->type_name("AXIS")
      ->check(CLI::IsMember({"y", "z"}));
  app.add_flag_function(
      "--follow-links",
      [&o](std::int64_t count) { o.links = count > 0 ? RasterLinks::followed : RasterLinks::refused; },
      "Open local files that a raster refers to, such as the sources of a VRT");
  cli::bind_meeting_options(app, o.rules);
}

/// True if --from names a terrain file, which is exported unchanged.
bool is_export(const ImportOptions& import) { return !import.from.empty() && is_landfall_file(import.from); }

void expand(JsonSource& source, const ImportOptions& import, const cli::CommonOptions& common) {
  if (!is_export(import)) return apply_import(source, import);
  require_plain_export(import, !common.config_names.empty() || !common.assignments.empty() || common.seed ||
                                   common.print_config);
}

void complete(JsonSource& source, const Options& o) {
  if (o.import.from.empty() || is_export(o.import)) return;
  complete_import(source, o.import, [&](const DemBase& dem, const SiteRequest& request) {
    return fit_site_of(dem, request, o.links);
  });
}

void check(const cli::Session& session, const ImportOptions& import) {
  if (is_export(import))
    static_cast<void>(LandfallFileReader(import.from, {"terrain"}));
  else
    static_cast<void>(terrain_config(session.config(), session.config_name()));
}

TerrainContent write(cli::Session& session, const Options& o) {
  const auto output = [&session, &o](const std::vector<std::string>& inputs) -> TerrainOutput {
    Provenance provenance = session.provenance();
    cli::add_meeting_options(provenance.options, o.rules);
    return {session.output(inputs), std::move(provenance), session.phases()};
  };
  if (is_export(o.import)) return export_terrain(o.import.from, output({o.import.from}));
  const TerrainConfig config = terrain_config(session.config(), session.config_name());
  const std::vector<std::string> inputs = input_files(config, session.options().output_path, o.links);
  TerrainOutput terrain = output(inputs);
  if (inputs.empty()) leave_current(terrain.file.path, "terrain", terrain.provenance);  // before the work
  return build_terrain(config, {o.links, o.rules}, std::move(terrain));
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("terrain-gen");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.has_seed = true;
  tool.writes_hdf5 = false;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.expand = [&](JsonSource& source, const cli::CommonOptions& common) {
    expand(source, options.import, common);
  };
  tool.complete = [&](JsonSource& source) { complete(source, options); };
  tool.check = [&](const cli::Session& session) { check(session, options.import); };
  tool.run = [&](cli::Session& session) {
    cli::report_terrain(session, write(session, options));
    return ExitCode::done;
  };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::terrain_gen
