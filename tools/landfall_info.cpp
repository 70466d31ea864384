// SPDX-License-Identifier: GPL-3.0-or-later
// landfall-info: describes the content of a landfall file.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <optional>

#include "app/cli/comparison_text.h"
#include "app/cli/description_text.h"
#include "app/cli/devices.h"
#include "app/cli/footprint_text.h"
#include "app/cli/meeting_options.h"
#include "app/cli/tool.h"
#include "app/report/comparison_page.h"
#include "app/runs/footprint_description.h"
#include "base/core/standard_streams.h"
#include "base/text/characters.h"
#include "base/text/parsed_number.h"
#include "base/text/shown_text.h"
#include "formats/points/cloud_reader.h"
#include "store/files/bin_description.h"
#include "store/files/comparison.h"
#include "store/files/contents.h"
#include "store/files/file_description.h"
#include "store/files/landfall_file.h"
#include "tools.h"

namespace landfall::landfall_info {
namespace {

constexpr const char* kExamples = R"(Examples:
  landfall-info scan.h5
  landfall-info terrain.h5 scan.h5 dem.h5 eval.h5
  landfall-info dem.h5 --json
  landfall-info scan.h5 --config | scan-sim -c - --terrain t.h5 -o b.h5
  landfall-info --compare a/eval.h5 b/eval.h5 --report ab.html
  landfall-info dem.h5 --at 12.5,-3 --scan scan.h5
  landfall-info eval.h5 --at 12.5,-3 --dem dem.h5 --scan scan.h5
  landfall-info --check *.h5
  landfall-info --seal changed.h5
  landfall-info --devices
Keys of --json: docs/user/landfall-info.md.)";

constexpr const char* kDescription =
    R"(Prints for each file its kind and origin, extent and frame, statistics of every layer and column, the pixel outcomes of a scan, the verdicts of an evaluation, the configuration where it differs from the defaults, and every step that led to the file.

Files are read in pieces, so that the memory does not depend on their size. A file that is damaged, incomplete or not a landfall file is refused with a one-line message; the other files are still described.

--compare says in words whether the second file, B, is better than the first, A, and shows where they differ: their configurations and those of the steps before them, requirements and metrics, the layers on the bins that both maps have in common once B is placed in the frame of A, and the draws of equal seeds in pairs. Of two scans it says how like they are, and what of that is beyond chance. All differences are B - A, B being the second file.

--at shows the layers of one bin of a DEM and, with --scan, each return that lies in it. Of an evaluation it shows the footprint that is centred on the bin: its errors and verdicts, its five worst bins and, with --dem and --scan, the likely cause of a failure.

--check only checks files, as every tool does when it opens one: the seal, the structure, links, filters and sizes, and that the file is complete. It prints a line for each file that is refused, and nothing for the others. It takes milliseconds, because values are not read: their own checksums show damage when they are read.

--seal adds the seal to files that other programs wrote or changed, after the checks of --check. The seal shows any damage that follows. A file that has one stays as it is.

--devices lists the OpenCL devices, and on which of them monte-carlo --engine opencl can draw errors: those with double precision that round as this CPU does.)";

struct Options {
  std::vector<std::string> files;
  bool json = false;
  bool no_statistics = false;
  bool config = false;
  bool check = false;
  bool seal = false;
  bool devices = false;
  bool compare = false;
  MeetingRules rules;
  std::string at;
  std::string dem;
  std::string scan;
  std::string report;
};

void bind(CLI::App& app, Options& o) {
  app.add_option("files", o.files,
                 "Files to describe (terrain.h5, scan.h5, dem.h5, eval.h5, plan.h5, hazards.h5 or draws.h5)")
      ->type_name("FILE...");
  CLI::Option* const compare = app.add_flag("--compare", o.compare,
                                            "Say whether the second of two files of one kind, B, is better "
                                            "than the first, A, and where they differ");
  CLI::Option* const at =
      app.add_option("--at", o.at,
                     "Show the bin of a DEM, or the footprint of an evaluation, at this place, metres")
          ->type_name("X,Y");
  app.add_option("--dem", o.dem, "The DEM of that evaluation, for the cause of a failure (dem.h5)")
      ->type_name("FILE")
      ->needs(at);
  app.add_option(
         "--scan", o.scan,
         "The scan that made the DEM: each return in that bin, or what a footprint's cause needs (scan.h5)")
      ->type_name("FILE")
      ->needs(at);
  app.add_option("--report", o.report,
                 "Also write the comparison as one HTML file with the maps of both and their difference")
      ->type_name("FILE")
      ->needs(compare);
  app.add_flag("--json", o.json, "Print a JSON object; an array for several files");
  app.add_flag("--no-statistics", o.no_statistics,
               "List layers and columns with their meaning, without reading values");
  app.add_flag("--config", o.config, "Print only the whole configuration, JSON for the tool's -c");
  app.add_flag("--check", o.check,
               "Check the files as every tool does when it opens them, and print only refusals; exit 1 if "
               "there is one");
  app.add_flag("--seal", o.seal,
               "Check the files, and add the seal that shows later damage where it is missing");
  app.add_flag("--devices", o.devices, "List the OpenCL devices instead: memory, double precision, use");
  cli::bind_meeting_options(app, o.rules);
}

nlohmann::ordered_json describe(cli::Session& session, const Options& o, const std::string& path) {
  nlohmann::ordered_json description;
  session.phase("read", [&](const ProgressCallback& progress) {
    description = describe_file(path, {.statistics = !o.no_statistics}, progress);
  });
  return description;
}

ExitCode list_devices(const Options& o) {
  if (!o.files.empty() || o.no_statistics || o.config || o.check || o.seal || o.compare || !o.at.empty())
    throw UsageError("--devices describes no file; omit files, --no-statistics, --config and --check");
  const nlohmann::ordered_json list = cli::device_list();
  standard_output() << shown_lines(o.json ? list.dump(2) + "\n" : cli::devices_text(list));
  return ExitCode::done;
}

/// Refuses a point file of another program, which would only be said to be no HDF5 file.
void refuse_points(const std::string& path) {
  std::error_code unreachable;
  if (std::filesystem::path(path).extension() != ".h5" &&
      std::filesystem::is_regular_file(path, unreachable) && is_cloud_file(path))
    throw FormatError(path + ": is a file of points, not of landfall; import it: landfall-import " + path +
                      " -o scan.h5");
}

/// Calls `work` for each file. One that is refused does not prevent the work on the others.
template <class Work>
ExitCode for_each_file(const cli::Session& session, const std::vector<std::string>& files, const Work& work) {
  ExitCode code = ExitCode::done;
  for (const std::string& path : files) {
    try {
      refuse_points(path);
      work(path);
    } catch (const Error& error) {
      if (files.size() == 1) throw;
      std::cerr << shown_text(session.tool() + ": " + error.what()) << '\n';
      code = error.exit_code();
    }
  }
  return code;
}

ExitCode check_files(const cli::Session& session, const Options& o) {
  if (o.json || o.no_statistics || o.config)
    throw UsageError(std::string(o.seal ? "--seal" : "--check") +
                     " describes no file; omit --json, --no-statistics and --config");
  return for_each_file(session, o.files,
                       [&](const std::string& path) { o.seal ? add_seal(path) : check_file(path); });
}

ExitCode describe_files(cli::Session& session, const Options& o) {
  nlohmann::ordered_json all = nlohmann::ordered_json::array();
  std::string gap;
  const ExitCode code = for_each_file(session, o.files, [&](const std::string& path) {
    const nlohmann::ordered_json description = describe(session, o, path);
    if (o.json)
      all.push_back(description);
    else
      standard_output() << gap << cli::description_text(description) << std::flush;
    gap = "\n";
  });
  if (o.json) standard_output() << shown_lines((o.files.size() == 1 ? all.at(0) : all).dump(2)) << '\n';
  return code;
}

/// Prints the configuration alone, so that a tool can read it: landfall-info scan.h5 --config | scan-sim -c
/// -.
ExitCode print_config(const Options& o) {
  if (o.json) throw UsageError("--config prints JSON, and --json the configuration with all else; omit one");
  if (o.files.size() != 1) throw UsageError("--config needs one file");
  standard_output() << cli::config_text(describe_file(o.files[0], {.statistics = false}));
  return ExitCode::done;
}

/// The output of --compare and --at.
template <class Text>
ExitCode print_json(const Options& o, const nlohmann::ordered_json& json, const Text& text) {
  standard_output() << (o.json ? shown_lines(json.dump(2)) + "\n" : text(json));
  return ExitCode::done;
}

ExitCode compare(cli::Session& session, const Options& o) {
  if (!o.at.empty() || o.config || o.check || o.seal)
    throw UsageError(
        "--compare takes only --json, --report, -O, --no-statistics, --same-frame and --vertical-datum");
  if (o.files.size() != 2) throw UsageError("--compare needs two files, A and B");
  const auto report_file = session.side_output("--report", o.report, o.files);
  html_report::ComparisonReport report;
  ComparisonRequest request{o.rules, !o.no_statistics};
  if (report_file)
    request.on_layer = [&](const auto& kind, const auto& layer, const auto& a, const auto& b) {
      report.take(kind, layer, a, b);
    };
  nlohmann::ordered_json json;
  session.phase("compare", [&](const ProgressCallback& progress) {
    json = compare_files(o.files[0], o.files[1], request, progress);
  });
  if (report_file) {
    write_text(*report_file, report.page(json));
    report_file->commit();
  }
  return print_json(o, json, cli::comparison_text);
}

SitePoint point_of(const std::string& text) {
  const std::string_view both = text;
  const std::size_t comma = std::min(both.find(','), both.size());
  const ParsedNumber x = parsed_number(trimmed(both.substr(0, comma)));
  const ParsedNumber y = parsed_number(trimmed(both.substr(std::min(comma + 1, both.size()))));
  const auto is_finite = [](const ParsedNumber& number) {
    return number.outcome == ParsedNumber::Outcome::number && std::isfinite(number.value);
  };
  if (!is_finite(x) || !is_finite(y))
    throw UsageError("--at " + abbreviated(text) + ": expected X,Y, metres");
  return {x.value, y.value};
}

ExitCode show_place(cli::Session& session, const Options& o) {
  if (o.no_statistics || o.config || o.check || o.seal)
    throw UsageError("--at takes only --dem, --scan and --json");
  if (o.files.size() != 1) throw UsageError("--at needs one DEM or evaluation");
  const auto optional = [](const std::string& path) {
    return path.empty() ? std::nullopt : std::optional<std::filesystem::path>(path);
  };
  const bool is_footprint = kind_of(LandfallFileReader(o.files[0], {"dem", "evaluation"})) == "evaluation";
  if (!is_footprint && !o.dem.empty())
    throw UsageError("--dem needs an evaluation; " + o.files[0] + " is a DEM");
  nlohmann::ordered_json json;
  session.phase("read", [&](const ProgressCallback& progress) {
    const SitePoint point = point_of(o.at);
    json = is_footprint ? describe_footprint(o.files[0], point, {optional(o.dem), optional(o.scan)}, progress)
                        : describe_bin(o.files[0], point, optional(o.scan), progress);
  });
  return print_json(o, json, is_footprint ? cli::footprint_text : cli::bin_text);
}

ExitCode run(cli::Session& session, const Options& o) {
  if (o.devices) return list_devices(o);
  if (o.compare) return compare(session, o);
  if (!o.at.empty()) return show_place(session, o);
  if (o.files.empty()) throw UsageError("a file to describe is required");
  if (o.check || o.seal) return check_files(session, o);
  return o.config ? print_config(o) : describe_files(session, o);
}

}  // namespace

int start(int argc, const char* const* argv, cli::Invocation* invocation) {
  Options options;
  cli::Tool tool("landfall-info");
  tool.description = kDescription;
  tool.examples = kExamples;
  tool.writes = false;
  tool.writes_side_file = true;
  tool.bind = [&](CLI::App& app) { bind(app, options); };
  tool.run = [&](cli::Session& session) { return run(session, options); };
  return cli::tool_main(argc, argv, tool, invocation);
}

}  // namespace landfall::landfall_info
