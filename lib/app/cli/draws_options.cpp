// SPDX-License-Identifier: GPL-3.0-or-later
// `--require-pass` means every draw, or that the sequential test accepts. A probability to be shown
// belongs in the stopping rule, where it is fixed before the first draw.
#include "app/cli/draws_options.h"

#include <CLI/CLI.hpp>
#include <memory>

#include "app/cli/meeting_options.h"
#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/text/split_text.h"

namespace landfall::cli {
namespace {

ScanPair scan_pair(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == text.size())
    throw UsageError("--pair " + text + ": expected SCAN:TERRAIN");
  return {text.substr(0, colon), text.substr(colon + 1)};
}

DrawSpan span_of(const std::string& text) {
  const auto ends = mapped(split_at(text, ':'), exact_number<std::int64_t>);
  if (ends.size() == 2 && ends[0] && ends[1] && *ends[0] >= 0 && *ends[0] < *ends[1])
    return {*ends[0], *ends[1]};
  throw UsageError("--draws " + text + ": expected A:B with 0 <= A < B");
}

}  // namespace

DrawsSources DrawsOptions::sources() const {
  DrawsSources sources{{}, samples};
  sources.rules = rules;
  if (engine != "cpu")
    sources.device = {.on_failure = engine == "opencl" ? DeviceFailure::throws : DeviceFailure::falls_back,
                      .use = std::make_shared<DeviceUse>()};
  for (const std::string& pair : pairs) sources.pairs.push_back(scan_pair(pair));
  if (sources.pairs.empty()) sources.pairs.push_back({traces() ? "" : inputs.front(), terrain});
  return sources;
}

std::optional<DrawSpan> DrawsOptions::part() const {
  return draws.empty() ? std::nullopt : std::optional(span_of(draws));
}

void bind_draws_options(CLI::App& app, DrawsOptions& o) {
  app.add_option(
         "scan", o.inputs,
         "Traced scan (scan.h5); without one each draw traces its own rays. Or: merge, and the parts of "
         "a run (draws.h5)")
      ->type_name("FILE...");
  app.add_option("--terrain", o.terrain, "Terrain that was scanned (terrain.h5), or that each draw scans")
      ->type_name("FILE");
  app.add_option("--pair", o.pairs,
                 "A scan and its terrain, in place of scan and --terrain; repeated: draws over each")
      ->type_name("SCAN:TERRAIN")
      ->allow_extra_args(false);
  app.add_option("--samples", o.samples,
                 "Values of varied keys, a column each and a row per draw (CSV or HDF5)")
      ->type_name("FILE");
  app.add_option("--draws", o.draws, "Run only a part, for merge: A:B, the draws A to B - 1")
      ->type_name("RANGE");
  app.add_option("--engine", o.engine,
                 "Where errors are drawn and returns gridded: cpu, opencl (an OpenCL device with double "
                 "precision; the same file), or opencl-or-cpu (cpu if the device cannot be used)")
      ->check(CLI::IsMember({"cpu", "opencl", "opencl-or-cpu"}))
      ->capture_default_str();
  app.add_option("--verdict", o.verdict,
                 "Write how many draws passed each requirement, with intervals, as JSON")
      ->type_name("FILE");
  app.add_option("--report", o.report,
                 "Write a report: one HTML file with maps, distributions and the failed draws")
      ->type_name("FILE");
  app.add_option("--title", o.title, "Title of the report; default: the site and the lidar in words")
      ->type_name("TEXT");
  app.add_flag("--table", o.table, "Print how many draws passed each requirement; default on a terminal");
  app.add_flag("--require-pass", o.require_pass,
               "Exit with 3 unless every draw passes, or the sequential test accepts");
  bind_meeting_options(app, o.rules);
}

void check_draws_options(const CommonOptions& common, const DrawsOptions& o) {
  if (!o.pairs.empty() && (!o.inputs.empty() || !o.terrain.empty()))
    throw UsageError("--pair names scan and terrain; omit " +
                     (o.inputs.empty() ? "--terrain" : o.inputs.front()));
  if (o.traces() && o.engine != "cpu")
    throw UsageError("--engine " + o.engine + ": draws without a scan are traced by the CPU");
  if (o.table && common.json_summary) throw UsageError("--table and --json both write to standard output");
  if (!o.title.empty() && o.report.empty()) throw UsageError("--title needs --report");
  if (o.report == "-") throw UsageError("--report needs a file");
  if (o.verdict == "-") throw UsageError("--verdict needs a file; --json prints it");
  if (o.merges()) {
    if (o.inputs.size() < 2) throw UsageError("merge needs the parts of a run");
    if (!o.terrain.empty() || !o.samples.empty() || !o.draws.empty() || !common.config_names.empty() ||
        !common.assignments.empty() || o.engine != "cpu")
      throw UsageError(
          "merge takes all from its parts; omit --terrain, --samples, --draws, --engine, -c and --set");
    return;
  }
  if (o.inputs.size() > 1) throw UsageError("one scan at a time; " + o.inputs[1] + " is a second one");
  if (!o.traces() && o.terrain.empty() && o.pairs.empty()) throw UsageError("--terrain is required");
}

}  // namespace landfall::cli
