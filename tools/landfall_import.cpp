// SPDX-License-Identifier: GPL-3.0-or-later
// landfall-import: makes a scan or a DEM of data that landfall did not make.
#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "app/cli/meeting_options.h"
#include "app/cli/tool.h"
#include "app/runs/cloud_import.h"
#include "app/runs/raster_import.h"
#include "base/text/characters.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "formats/points/cloud_reader.h"
#include "store/files/landfall_file.h"
#include "tools.h"

namespace landfall::landfall_import {
namespace {

constexpr const char* kExamples = R"(Examples:
  landfall-import strip.las -o scan.h5
  landfall-import strip.las -o scan.h5 --center 548356,5389943,320
  landfall-import points.csv -o scan.h5 --crs EPSG:32632 \
    --columns x=E,y=N,z=H
  landfall-import leg000_points.xyz -o scan.h5     HELIOS++
  landfall-import dem.tif --truth truth.tif -o dem.h5
  landfall-import dem.tif --terrain terrain.h5 --center 3800,3380 -o dem.h5
The next steps are regrid, dem-eval and hazard-map, as for a scan of scan-sim.
docs/user/judge-your-own-data.md has whole examples.)";

constexpr const char* kDescription =
    R"(Writes points as scan.h5 in a site frame, so that regrid, dem-eval and hazard-map judge them. Read are LAS 1.0 to 1.4, PLY, PCD, PTX, QFIT of ATM, CSV and other text, and the .xyz files of HELIOS++. LAZ and E57 must be converted first.

A raster that GDAL reads becomes dem.h5 on its own grid, with the true elevations of another raster or of a terrain. Its pixels must be square and north up, in metres or another unit of length.

Coordinates become metres around the centre. The CRS is that of the file or of --crs; longitudes and latitudes, and maps whose scale at the site is not 1, are projected to a plane at the centre. Without a CRS they are taken as metres, unless the names of their columns state a unit; longitudes and latitudes need a CRS.)";

constexpr const char* kKeepFills = "none";  // --nodata

struct Options {
  CloudImport cloud;
  RasterImport raster;
  std::string center;
  std::string vertical_scale;
  std::string time_unit;
  std::string up, axis_order;
  bool keep_noise = false, first_only = false, last_only = false;
  std::string nodata;
  std::optional<int> band;
};

void bind(CLI::App& app, Options& o) {
  app.add_option(
         "input", o.cloud.path,
         "File to import: points (.las, .ply, .pcd, .ptx, .qi, .csv, .xyz, .txt), or a raster that GDAL "
         "reads; its content decides")
      ->type_name("FILE");
  app.add_option(
         "--center", o.center,
         "Origin of the site frame in the units of the data (metres where a header states other lengths "
         "and there is no CRS); default: the middle of the data, to a "
         "metre, and height 0")
      ->type_name("E,N[,H]");
  CLI::Option* const truth =
      app.add_option("--truth", o.raster.truth, "Raster of the true elevations of a raster")
          ->type_name("FILE");
  app.add_option("--terrain", o.raster.terrain, "True terrain (terrain.h5) of a raster")
      ->type_name("FILE")
      ->excludes(truth);
  cli::bind_meeting_options(app, o.raster.rules, "--other-terrain");
  app.add_option("--crs", o.cloud.crs,
                 "CRS of the data: EPSG:NUMBER, a PROJ text or WKT; default: that of the file")
      ->type_name("DEF");
  app.add_option(
         "--columns", o.cloud.columns,
         "Columns of a text, PLY or PCD by name or number, or - for none; FIELD is x, y, z, intensity, "
         "return_number, number_of_returns, t, pulse, pixel or classification")
      ->type_name("FIELD=COLUMN,...");
  app.add_flag("--keep-noise", o.keep_noise,
               "Keep points marked as noise (classes 7 and 18) or withheld, as false returns; default: leave "
               "them out");
  CLI::Option* const first = app.add_flag("--first-only", o.first_only, "Only first returns");
  app.add_flag("--last-only", o.last_only, "Only last returns")->excludes(first);
  CLI::Option* const up =
      app.add_option(
             "--up", o.up,
             "Axis of the file that points up: z (default), or y, which turns (x, y, z) to (x, -z, y)")
          ->type_name("AXIS")
          ->check(CLI::IsMember({"y", "z"}));
  app.add_option(
         "--axis-order", o.axis_order,
         "Order of the horizontal axes in the file: xy (default), or yx for latitude or northing first")
      ->type_name("ORDER")
      ->check(CLI::IsMember({"xy", "yx"}))
      ->excludes(up);
  app.add_option(
         "--time-unit", o.time_unit,
         "Unit of the times of a text, PLY or PCD: s, ms, us or ns; default: s, unless a time is beyond "
         "1e12")
      ->type_name("UNIT")
      ->check(CLI::IsMember({"s", "ms", "us", "ns"}));
  app.add_option("--vertical-scale", o.vertical_scale,
                 "Metres per unit of the heights; default: the unit of the CRS, else 1")
      ->type_name("FACTOR");
  app.add_option(
         "--nodata", o.nodata,
         "Values that are no elevations, separated by commas: points with such a z are left out, such "
         "samples of a raster and of its --truth are holes. none: numbers that look like undeclared "
         "fill values are kept")
      ->type_name("VALUE[,...]");
  app.add_option("--band", o.band,
                 "Band of a raster; default: the first, unless it is a colour, which only a given number "
                 "accepts")
      ->type_name("N");
}

double number_of(const std::string& text, const char* option) {
  double number = 0;
  const std::string_view digits = trimmed(text);
  const char* const end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number))
    throw UsageError(std::string(option) + ": '" + abbreviated(text) + "' is not a number");
  return number;
}

std::vector<double> numbers_of(const std::string& text, const char* option) {
  std::vector<double> numbers;
  if (text.empty()) return numbers;
  for (const std::string& part : CLI::detail::split(text, ',')) numbers.push_back(number_of(part, option));
  return numbers;
}

/// E,N or E,N,H.
std::vector<double> center_of(const std::string& text) {
  std::vector<double> center = numbers_of(text, "--center");
  if (text.empty()) return center;
  if (center.size() != 2 && center.size() != 3)
    throw UsageError("--center: '" + abbreviated(text) + "' is not E,N or E,N,H");
  return center;
}

void report_cloud(cli::Session& session, const ImportedCloud& cloud) {
  session.count("point_count", cloud.point_count);
  session.count("format", cloud.format);
  session.count("center", cloud.center);
  session.count("crs", cloud.crs_name.empty() ? nlohmann::json() : nlohmann::json(cloud.crs_name));
  session.count("x_m", cloud.bounds_m[0]);
  session.count("y_m", cloud.bounds_m[1]);
  session.count("z_m", cloud.bounds_m[2]);
  session.count("left_out", {{"without_position", cloud.left_out.without_position},
                             {"noise", cloud.left_out.noise},
                             {"withheld", cloud.left_out.withheld},
                             {"other_returns", cloud.left_out.other_returns}});
  for (const std::string& warning : cloud.warnings) session.warn(warning);
  const auto range = [&](std::size_t axis) {
    return short_number(cloud.bounds_m[axis][0]) + " to " + short_number(cloud.bounds_m[axis][1]);
  };
  session.conclude(grouped(cloud.point_count) + " points of " + cloud.format + "; x " + range(0) + " m, y " +
                   range(1) + " m, z " + range(2) + " m around " + number_text(cloud.center[0]) + ", " +
                   number_text(cloud.center[1]) + ", " + number_text(cloud.center[2]));
}

void report_dem(cli::Session& session, const ImportedDem& dem) {
  session.count("rows", dem.grid.rows);
  session.count("columns", dem.grid.cols);
  session.count("resolution_m", dem.grid.resolution_m);
  session.count("center", dem.center);
  session.count("empty_bin_count", dem.empty_bins);
  session.count("bins_with_truth",
                dem.bins_with_truth ? nlohmann::json(*dem.bins_with_truth) : nlohmann::json());
  for (const std::string& warning : dem.warnings) session.warn(warning);
  session.conclude(grouped(dem.grid.cols) + " x " + grouped(dem.grid.rows) + " bins of " +
                   number_text(dem.grid.resolution_m) + " m around " + number_text(dem.center[0]) + ", " +
                   number_text(dem.center[1]) + "; " + grouped(dem.empty_bins) + " empty");
}

std::optional<double> vertical_scale_of(const std::string& text) {
  constexpr double kLargest = 1e6;
  if (text.empty()) return std::nullopt;
  const double scale = number_of(text, "--vertical-scale");
  if (!(scale >= 1 / kLargest && scale <= kLargest))
    throw UsageError("--vertical-scale: " + abbreviated(text) + " is not in [1e-6, 1e6]");
  return scale;
}

/// The options that only points have.
void require_no_point_options(const Options& o) {
  const std::array<std::pair<const char*, bool>, 7> given = {{{"--columns", !o.cloud.columns.empty()},
                                                              {"--keep-noise", o.keep_noise},
                                                              {"--first-only", o.first_only},
                                                              {"--last-only", o.last_only},
                                                              {"--up", !o.up.empty()},
                                                              {"--axis-order", !o.axis_order.empty()},
                                                              {"--time-unit", !o.time_unit.empty()}}};
  for (const auto& [option, is_given] : given)
    if (is_given)
      throw UsageError(std::string(option) + " is for points; " + o.cloud.path + " is read as a raster");
}

void import_dem(cli::Session& session, const Options& o) {
  require_no_point_options(o);
  RasterImport import = o.raster;
  import.dem.path = o.cloud.path;
  import.dem.crs = o.cloud.crs;
  import.dem.vertical_scale = vertical_scale_of(o.vertical_scale);
  import.dem.band = o.band.value_or(1);
  import.dem.takes_colours = o.band.has_value();
  import.dem.keeps_undeclared_fills = o.nodata == kKeepFills;
  if (o.nodata != kKeepFills) import.dem.nodata = numbers_of(o.nodata, "--nodata");
  const std::vector<double> center = center_of(o.center);
  if (center.size() == 3) throw UsageError("--center: a raster keeps its heights: give E,N");
  if (!center.empty()) import.dem.center = std::array<double, 2>{center[0], center[1]};
  const OutputOptions output = session.output({o.cloud.path, import.truth, import.terrain});
  Provenance provenance = session.provenance();
  cli::add_meeting_options(provenance.options, import.rules);
  report_dem(session, import_raster(import, {output, std::move(provenance), session.phases()}));
}

void require_foreign_files(const Options& o) {
  if (is_landfall_file(o.cloud.path))
    throw UsageError(o.cloud.path + ": is a landfall file already and needs no import");
  if (is_landfall_file(o.raster.truth))
    throw UsageError("--truth " + o.raster.truth +
                     ": is a landfall file, not a raster; --terrain takes a terrain.h5");
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.cloud.path.empty()) throw UsageError("a file to import is required");
  require_foreign_files(o);
  const bool has_truth = !o.raster.truth.empty() || !o.raster.terrain.empty();
  if (!is_cloud_file(o.cloud.path)) {
    import_dem(session, o);
    return ExitCode::done;
  }
  if (has_truth)
    throw UsageError("--truth and --terrain are for rasters; give regrid the --terrain of points");
  if (o.band) throw UsageError("--band is for rasters; " + o.cloud.path + " is read as points");
  CloudImport import = o.cloud;
  import.selection = {.keep_noise = o.keep_noise,
                      .returns = o.first_only  ? ReturnChoice::first
                                 : o.last_only ? ReturnChoice::last
                                               : ReturnChoice::all};
  import.axes = {.latitude_first = o.axis_order == "yx", .y_up = o.up == "y"};
  import.up_is_given = !o.up.empty();
  if (!o.time_unit.empty()) import.time_unit = time_unit(o.time_unit);
  import.nodata.keeps_undeclared_fills = o.nodata == kKeepFills;
  if (o.nodata != kKeepFills) import.nodata.z = numbers_of(o.nodata, "--nodata");
  import.center = center_of(o.center);
  import.vertical_scale = vertical_scale_of(o.vertical_scale);
  const OutputOptions output = session.output({import.path});
  report_cloud(session, import_cloud(import, {output, session.provenance(), session.phases()}));
  return ExitCode::done;
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("landfall-import");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::landfall_import
