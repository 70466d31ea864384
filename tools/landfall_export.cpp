// SPDX-License-Identifier: GPL-3.0-or-later
// landfall-export: converts a landfall file to formats of other programs.
#include <CLI/CLI.hpp>

#include "app/cli/tool.h"
#include "app/exports/file_export.h"
#include "app/runs/cloud_output.h"
#include "base/output/byte_sink.h"
#include "tools.h"

namespace landfall::landfall_export {
namespace {

constexpr const char* kExamples = R"(Examples:
  landfall-export scan.h5 -o scan.html             a browser; up to 1 M points
  landfall-export scan.h5 -o scan.ply              CloudCompare, ParaView
  landfall-export scan.h5 -o scan.las --time gps
  landfall-export scan.h5 -o scan.pcd              PCL, Open3D, ROS
  landfall-export scan.h5 -o scan.xmf              ParaView, meshio; no copy
  landfall-export scan.h5 -o - --format csv --columns x_est,y_est,z_est | head
  landfall-export dem.h5 -o dem.tif --layers z_est,count  GIS
  landfall-export eval.h5 -o eval.csv --layers fail
  landfall-export eval.h5 -o eval.png --layers rel_z        a picture
  landfall-export hazards.h5 -o sites.gpkg --sites          GIS
docs/user/landfall-export.md lists the formats for each kind of file.)";

void bind(CLI::App& app, ExportOptions& o) {
  app.add_option("input", o.input, "File to export: terrain, scan, DEM, evaluation, plan or hazard map")
      ->type_name("FILE");
  app.add_option("--format", o.format,
                 "Output format; default: from the extension of the output; csv with -o -")
      ->check(CLI::IsMember(export_formats()));
  app.add_option(
         "--layers", o.layers,
         "Layers of a grid, comma-separated, or all; a .png shows one layer, or for a scan one column "
         "or count; default: the main layer")
      ->type_name("NAME,...")
      ->delimiter(',');
  app.add_option("--columns", o.columns, "Columns of a scan's points, comma-separated; default: all")
      ->type_name("NAME,...")
      ->delimiter(',');
  app.add_option("--position", o.position, "Positions of the points: est (estimated, default) or true")
      ->check(CLI::IsMember({"est", "true"}));
  app.add_option("--frame", o.frame,
                 "csv, las, pcd, ply: frame of the positions: that of the map from which the site was taken, "
                 "with its CRS, or that of the site; default: map where there is one")
      ->check(CLI::IsMember({"site", "map"}));
  app.add_option("--every", o.every, "Only the first point (line of a .csv), and every N-th after it")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40U))
      ->capture_default_str();
  app.add_flag("--keep-misses", o.keep_misses, "csv: also the points without a return");
  app.add_option(
         "--time", o.time,
         "las: times as seconds since the first pulse (scan, default), or as adjusted standard GPS time "
         "(gps) if the trajectory's clock shows GPS seconds")
      ->check(CLI::IsMember({"scan", "gps"}));
  app.add_option("--max-points", o.max_points,
                 "html: the most points to show, thinned by a grid; default: 1000000")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, kMaxCloudPoints));
  app.add_flag("--sites", o.sites, "csv, gpkg: the landing sites of a hazard map, not its layers");
}

ExitCode run(cli::Session& session, const ExportOptions& o) {
  if (o.input.empty()) throw UsageError("a file to export is required");
  const std::string& name = session.options().output_path;
  if (name == "-" && session.options().json_summary)
    throw UsageError("-o - and --json both write to standard output");
  const OutputOptions output = name == "-" ? OutputOptions{name} : session.output({o.input});
  const FileExport file_export(o, name);
  const std::string second = file_export.second_output();
  if (!second.empty()) session.claim_output("-o", second, {o.input});
  std::string remark;
  try {
    session.phase("export", [&](const ProgressCallback& progress) {
      if (file_export.format() == "html")
        write_cloud_page(o.input, output, o.max_points == 0 ? kMaxCloudPoints : o.max_points, progress);
      else
        remark = file_export.write(output, session.tool(), progress);
    });
  } catch (const ClosedPipe&) {
    session.log("the reader of standard output has closed it");
  }
  if (!remark.empty()) session.warn(remark);
  return ExitCode::done;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  ExportOptions options;
  cli::Tool tool("landfall-export");
  tool.examples = kExamples;
  tool.writes_hdf5 = false;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::landfall_export
