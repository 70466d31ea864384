// SPDX-License-Identifier: GPL-3.0-or-later
// landfall-export: writes what a landfall file holds in the formats of other programs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>

#include "base/file_extension.h"
#include "cli/tool.h"
#include "exports/csv.h"
#include "exports/grid_layers.h"
#include "exports/las.h"
#include "exports/ply.h"
#include "exports/point_reader.h"
#include "exports/quick_look.h"
#include "exports/terrain_export.h"
#include "exports/xdmf.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  landfall-export scan.h5 -o scan.ply                          CloudCompare, ParaView
  landfall-export scan.h5 -o scan.las --position true
  landfall-export scan.h5 -o scan.xmf                          ParaView, meshio: without a copy
  landfall-export scan.h5 -o - --format csv --columns x_est,y_est,z_est | head
  landfall-export dem.h5 -o dem.tif --layers z_est,count       GIS
  landfall-export eval.h5 -o eval.csv --layers fail
  landfall-export eval.h5 -o eval.png --layers rel_z           a picture to look at
docs/landfall-export.md tells what becomes what.)";

struct Options {
  std::string input;
  std::string format;
  std::vector<std::string> layers;
  std::vector<std::string> columns;
  std::string position;
  std::size_t every = 1;
  bool keep_misses = false;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("input", o.input, "File to export: terrain, scan, DEM, evaluation or plan")
      ->type_name("FILE");
  app.add_option("--format", o.format, "Format, where the output's extension does not say it; with -o -: csv")
      ->check(CLI::IsMember({"csv", "las", "ply", "png", "tif", "xmf"}));
  app.add_option("--layers", o.layers,
                 "Layers of a grid, comma-separated, or all; for .png one layer, or a column of a scan or "
                 "count; default: "
                 "the main one")
      ->type_name("NAME,...")
      ->delimiter(',');
  app.add_option("--columns", o.columns, "Columns of a scan's points, comma-separated; default: all")
      ->type_name("NAME,...")
      ->delimiter(',');
  app.add_option("--position", o.position, "Which places of the points: est (default) or true")
      ->check(CLI::IsMember({"est", "true"}));
  app.add_option("--every", o.every, "Only the first point (line of a .csv), and every N-th after it")
      ->type_name("N")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 40U))
      ->capture_default_str();
  app.add_flag("--keep-misses", o.keep_misses, "csv: also the points without a return");
}

/// What the output is to be: "csv", "las", ...; the extensions' first names.
std::string format_of(const Options& o, const std::string& output) {
  if (output == "-") {
    if (o.format.empty()) throw UsageError("-o - needs --format csv");
    if (o.format != "csv")
      throw UsageError("--format " + o.format + " does not go to standard output; csv does");
    return o.format;
  }
  const std::string extension = file_extension(output);
  std::string named;
  if (extension == ".xdmf") named = "xmf";
  if (extension == ".tiff") named = "tif";
  for (const char* const known : {"csv", "las", "ply", "png", "tif", "xmf"})
    if (extension == std::string(".") + known) named = known;
  if (!named.empty() && !o.format.empty() && named != o.format)
    throw UsageError("output " + output + ": its extension says " + named + ", --format " + o.format);
  if (!o.format.empty()) return o.format;
  if (named.empty())
    throw UsageError("output " + output + ": extension '" + extension +
                     "' is none of .csv, .las, .ply, .png, .tif, .xmf; --format names one");
  return named;
}

/// Throws UsageError unless a file of this kind can become this.
void require_possible(const LandfallFileReader& file, const std::string& kind, const std::string& format) {
  const std::string& input = file.name();
  if (h5::exists(file.root(), "mesh") && format != "png")
    throw UsageError(input + " is a mesh terrain, which can become .png; terrain-gen --from " + input +
                     " -o mesh.ply exports the mesh");
  const bool is_scan = kind == "scan";
  const bool possible = is_scan ? format != "tif" : format != "las" && format != "ply";
  if (possible) return;
  throw UsageError(input + " is a landfall." + kind + " file, which can become " +
                   (is_scan ? ".csv, .las, .ply, .png or .xmf" : ".csv, .png, .tif or .xmf") + "; not ." +
                   format);
}

/// Throws UsageError for an option that has no part in an export to this format.
void require_no_stray_option(const Options& o, bool is_scan, const std::string& format) {
  const auto refuse = [](bool given, const std::string& option, const std::string& where) {
    if (given) throw UsageError(option + " has no part in " + where);
  };
  const std::string here = std::string("the export of a ") + (is_scan ? "scan" : "grid") + " to ." + format;
  refuse(!o.layers.empty() && is_scan && format != "png", "--layers", here);
  refuse(!o.columns.empty() && !(is_scan && (format == "csv" || format == "ply")), "--columns", here);
  refuse(!o.position.empty() && !(is_scan && format != "csv" && format != "png"), "--position", here);
  refuse(o.every != 1 && !(format == "csv" || format == "ply" || format == "las"), "--every", here);
  refuse(o.keep_misses && !(is_scan && format == "csv"), "--keep-misses", here);
}

void require_each_once(const std::vector<std::string>& columns) {
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (std::find(columns.begin(), columns.begin() + static_cast<std::ptrdiff_t>(i), columns[i]) !=
        columns.begin() + static_cast<std::ptrdiff_t>(i))
      throw UsageError("--columns names " + columns[i] + " twice");
}

/// The columns that are asked for; by default those of the file.
std::vector<std::string> chosen_columns(const PointReader& points, const Options& o) {
  require_each_once(o.columns);
  for (const std::string& name : o.columns) static_cast<void>(points.column(name));
  if (!o.columns.empty()) return o.columns;
  std::vector<std::string> names;
  for (const ContentInfo& column : points.columns())
    if (column.name != "t") names.push_back(column.name);
  return names;
}

std::string position_of(const Options& o) { return o.position.empty() ? "est" : o.position; }

/// x, y and z first, then the others.
PointReader::Pass ply_pass(const PointReader& points, const Options& o) {
  PointReader::Pass pass{position_columns(position_of(o)), {true, o.every}, 3};
  for (const std::string& name : chosen_columns(points, o))
    if (std::find(pass.columns.begin(), pass.columns.begin() + 3, name) == pass.columns.begin() + 3)
      pass.columns.push_back(name);
  return pass;
}

/// A scan's own rows cannot be left out of what only refers to them.
void require_only_returns(const PointReader& points) {
  if (points.count({true, 1}) != points.row_count())
    throw UsageError(points.file().name() +
                     " keeps points without a return, which an .xmf cannot leave out; export .ply");
}

std::string reference(const Options& o, const cli::Session& session) {
  return xdmf_reference(o.input, session.options().output_path);
}

/// The .xmf, and beside it the places that it refers to, which get their name before it.
void export_points_xdmf(const cli::Session& session, const Options& o, const PointReader& points,
                        ByteSink& sink) {
  require_only_returns(points);
  const cli::CommonOptions& options = session.options();
  const std::filesystem::path file = xdmf_places(options.output_path);
  const PointPlaces places = places_of(points, position_of(o), reference(o, session));
  OutputPath places_output(file, options.overwrite);
  write_point_places(places_output, places, session.tool(), options.compression);
  std::vector<ContentInfo> columns = points.columns();
  std::erase_if(columns, [](const ContentInfo& column) { return column.name == "t"; });
  sink.write(points_xdmf(columns, places, file.filename().string()));
  sink.flush();
  places_output.commit();
}

void export_scan(const cli::Session& session, const Options& o, const std::string& format, ByteSink& sink,
                 const ProgressCallback& progress) {
  const PointReader points(o.input);
  if (format == "csv") {
    write_points_csv(points, {chosen_columns(points, o), {!o.keep_misses, o.every}}, sink, progress);
  } else if (format == "ply") {
    write_points_ply(points, ply_pass(points, o), sink, progress);
  } else if (format == "las") {
    write_points_las(points, position_of(o), o.every, session.tool() + " " + program_version(), sink,
                     progress);
  } else {
    export_points_xdmf(session, o, points, sink);
  }
}

/// Files that GDAL writes.
void export_geotiff(const cli::Session& session, const Options& o, const OutputOptions& output,
                    const ProgressCallback& progress) {
  const GridSource grid(o.input);
  const std::vector<NamedLayer> layers =
      grid.read(grid.choose(o.layers), [&](double f) { report(progress, f / 2); });
  GeotiffContent content{{}, grid.crs_wkt(), source_line(session.tool()), grid.file().file_id()};
  for (const NamedLayer& layer : layers)
    content.bands.push_back(
        {std::visit([](const auto& values) { return decltype(GeotiffBand::values)(&values); }, layer.values),
         layer.info.units, layer.info.name});
  write_geotiff(output, content, [&](double f) { report(progress, (1 + f) / 2); });
}

void export_picture(const Options& o, const OutputOptions& output, const ProgressCallback& progress) {
  std::string names;
  for (const std::string& name : o.layers) names += (names.empty() ? "" : ",") + name;
  if (o.layers.size() > 1 || names == "all")
    throw UsageError("a .png shows one layer; --layers names " + names);
  write_png(output, quick_look(o.input, o.layers.empty() ? "" : o.layers.front(), progress));
}

void export_grid(cli::Session& session, const Options& o, const std::string& format, ByteSink& sink,
                 const ProgressCallback& progress) {
  const GridSource grid(o.input);
  const std::vector<ContentInfo> chosen =
      format == "xmf" && o.layers.empty() ? grid.layers() : grid.choose(o.layers);
  if (format == "xmf") {
    sink.write(grid_xdmf(chosen, grid.spec(), reference(o, session)));
    return;
  }
  const std::vector<NamedLayer> layers = grid.read(chosen, [&](double f) { report(progress, f / 4); });
  write_layers_csv(layers, o.every, sink, [&](double f) { report(progress, (1 + 3 * f) / 4); });
}

std::unique_ptr<ByteSink> open_sink(const cli::Session& session) {
  const cli::CommonOptions& options = session.options();
  if (options.output_path == "-") return std::make_unique<StandardOutputSink>();
  return std::make_unique<FileSink>(options.output_path, options.overwrite);
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.input.empty()) throw UsageError("a file to export is required");
  const std::string& name = session.options().output_path;
  if (name == "-" && session.options().json_summary) throw UsageError("-o - and --json both want stdout");
  OutputOptions output;
  if (name != "-") output = session.output({o.input});
  const std::string format = format_of(o, name);
  const LandfallFileReader file(o.input, {"terrain", "scan", "dem", "evaluation", "plan"});
  const std::string kind = kind_of(file);
  require_possible(file, kind, format);
  require_no_stray_option(o, kind == "scan", format);
  if (kind == "scan" && format == "xmf") session.claim_output("-o", xdmf_places(name).string(), {o.input});
  try {
    session.phase("export", [&](const ProgressCallback& progress) {
      if (format == "tif") return export_geotiff(session, o, output, progress);
      if (format == "png") return export_picture(o, output, progress);
      const std::unique_ptr<ByteSink> sink = open_sink(session);
      if (kind == "scan")
        export_scan(session, o, format, *sink, progress);
      else
        export_grid(session, o, format, *sink, progress);
      sink->finish();
    });
  } catch (const ClosedPipe&) {
    session.log("the reader of standard output has closed it");
  }
  return ExitCode::done;
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  Options options;
  cli::Tool tool;
  tool.name = "landfall-export";
  tool.summary = "Writes what a landfall file holds in the formats of other programs.";
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool);
}
