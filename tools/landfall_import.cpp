// SPDX-License-Identifier: GPL-3.0-or-later
// landfall-import: makes a scan or a DEM of data that landfall did not make.
#include <CLI/CLI.hpp>
#include <charconv>
#include <cmath>
#include <system_error>
#include <vector>

#include "base/abbreviated.h"
#include "base/number_text.h"
#include "cli/tool.h"
#include "imports/cloud_reader.h"
#include "runs/cloud_import.h"
#include "tools.h"

namespace landfall {
namespace {

constexpr const char* kExamples = R"(Examples:
  landfall-import strip.las -o scan.h5
  landfall-import strip.las -o scan.h5 --center 548356,5389943,320
  landfall-import points.csv -o scan.h5 --crs EPSG:32632 \
    --columns x=E,y=N,z=H
  landfall-import leg000_points.xyz -o scan.h5     HELIOS++
The next steps are regrid, dem-eval and hazard-map, as for a scan of scan-sim.
docs/user/judge-your-own-data.md has whole examples.)";

constexpr const char* kDescription =
    R"(Writes points as scan.h5 in a site frame, so that regrid, dem-eval and hazard-map judge them. Read are LAS 1.0 to 1.4, PLY, PCD, CSV and other text, and the .xyz files of HELIOS++. LAZ and E57 must be converted first.

Coordinates become metres around the centre. The CRS is that of the file or of --crs; longitudes and latitudes, and maps whose scale at the site is not 1, are projected to a plane at the centre. Without a CRS they are taken as metres.)";

struct Options {
  CloudImport cloud;
  std::string center;
  std::string vertical_scale;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("input", o.cloud.path, "File to import: points (.las, .ply, .pcd, .csv, .xyz, .txt)")
      ->type_name("FILE");
  app.add_option("--center", o.center,
                 "Origin of the site frame in the units of the data; default: the middle of the data, to a "
                 "metre, and height 0")
      ->type_name("E,N[,H]");
  app.add_option("--crs", o.cloud.crs,
                 "CRS of the points: EPSG:NUMBER, a PROJ text or WKT; default: that of the file")
      ->type_name("DEF");
  app.add_option("--columns", o.cloud.columns,
                 "Columns of a text, PLY or PCD by name or number; FIELD is x, y, z, intensity, "
                 "return_number, t, pulse, pixel or classification")
      ->type_name("FIELD=COLUMN,...");
  app.add_option("--vertical-scale", o.vertical_scale,
                 "Metres per unit of the heights; default: the unit of the CRS, else 1")
      ->type_name("FACTOR");
}

double number_of(const std::string& text, const char* option) {
  double number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end || !std::isfinite(number))
    throw UsageError(std::string(option) + ": '" + abbreviated(text) + "' is not a number");
  return number;
}

/// E,N or E,N,H.
std::vector<double> center_of(const std::string& text) {
  std::vector<double> center;
  if (text.empty()) return center;
  for (const std::string& part : CLI::detail::split(text, ',')) center.push_back(number_of(part, "--center"));
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
  for (const std::string& warning : cloud.warnings) session.warn(warning);
  const auto range = [&](std::size_t axis) {
    return short_number(cloud.bounds_m[axis][0]) + " to " + short_number(cloud.bounds_m[axis][1]);
  };
  session.conclude(grouped(cloud.point_count) + " points of " + cloud.format + "; x " + range(0) + " m, y " +
                   range(1) + " m, z " + range(2) + " m around " + number_text(cloud.center[0]) + ", " +
                   number_text(cloud.center[1]) + ", " + number_text(cloud.center[2]));
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.cloud.path.empty()) throw UsageError("a file to import is required");
  CloudImport import = o.cloud;
  import.center = center_of(o.center);
  if (!o.vertical_scale.empty()) {
    import.vertical_scale = number_of(o.vertical_scale, "--vertical-scale");
    if (*import.vertical_scale == 0) throw UsageError("--vertical-scale: 0 is not allowed");
  }
  const OutputOptions output = session.output({import.path});
  report_cloud(session, import_cloud(import, {output, session.provenance(), session.phases()}));
  return ExitCode::done;
}

}  // namespace

int landfall_import(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool;
  tool.name = "landfall-import";
  tool.summary = "Imports points that landfall did not make, to grid and judge them.";
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall
