// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/session.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <iostream>

#include "app/cli/progress_bar.h"
#include "app/cli/run_log.h"
#include "app/cli/tool.h"
#include "app/exports/file_export.h"
#include "app/exports/quick_look.h"
#include "base/core/parallel.h"
#include "base/dictionary/tables/stages.h"
#include "base/text/file_path.h"
#include "base/text/json_text.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "formats/picture/rgb_image.h"
#include "store/config/json_source.h"
#include "store/config/path_names.h"
#include "store/config/presets.h"
#include "store/config/resolved_config.h"
#include "store/config/schema.h"
#include "store/files/current_output.h"

namespace landfall::cli {
namespace {

using Json = nlohmann::json;

/// Adds the files that a configuration names.
void add_named_files(const Json& value, std::vector<std::string>& files) {
  for (const char* const key : kPathKeys)
    if (value.is_object() && value.contains(key) && value[key].is_string())
      files.push_back(value[key].get<std::string>());
  if (value.is_structured())
    for (const Json& element : value) add_named_files(element, files);
}

/// The formats of other programs that the extension of an output may name, besides those of landfall-export.
constexpr std::array kForeignExtensions = {".asc", ".e57", ".gz",  ".img", ".jpeg", ".jpg", ".json", ".laz",
                                           ".obj", ".off", ".stl", ".txt", ".vrt",  ".xyz", ".zip"};

/// A tool that writes HDF5 would give the file a name that other programs misunderstand.
void require_hdf5_name(const std::string& tool, const std::string& path) {
  const std::string extension = file_extension(path);
  if (std::ranges::find(kForeignExtensions, extension) == kForeignExtensions.end() &&
      !is_exported("", extension))
    return;
  const std::string own = std::filesystem::path(path).replace_extension(".h5").string();
  std::string message = "output " + path + ": " + tool + " writes HDF5; name it " + own;
  const auto* const stage = std::ranges::find(dictionary::kStages, tool, &dictionary::Stage::tool);
  if (is_exported(stage == dictionary::kStages.end() ? "" : stage->kind, extension))
    message += ", then run: landfall-export " + own + " -o " + path;
  throw UsageError(message);
}

Json environment_json(const std::string& config_name) {
  char host[256] = "";
  gethostname(host, sizeof host - 1);
  const std::time_t now = std::time(nullptr);
  char clock[32] = "";
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::strftime(clock, sizeof clock, "%Y-%m-%dT%H:%M:%SZ", &utc);
  return {{"host", as_utf8(host)},
          {"time_utc", clock},
          {"folder", as_utf8(std::filesystem::current_path().string())},
          {"config", config_name}};
}

std::int64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

}  // namespace

bool CommonOptions::shows_table(bool is_asked) const {
  return is_asked || (isatty(STDOUT_FILENO) != 0 && !quiet && !json_summary);
}

Session::Session(const Tool& tool, const CommonOptions& options, RunLog& log, const Host* host)
    : tool_(tool.name),
      schema_(tool.schema),
      options_(options),
      log_(log),
      host_(host),
      writes_hdf5_(tool.writes_hdf5),
      start_s_(wall_seconds()) {}

void Session::resolve_config(const Tool& tool) {
  JsonSource source = read_config(options_.config_names, schema_);
  if (tool.expand) tool.expand(source, options_);
  apply_assignments(source, options_.assignments,
                    [&](const nlohmann::json& config, const std::string& pointer) {
                      return default_at(config, embedded_schema(schema_), pointer);
                    });
  if (tool.complete) tool.complete(source);
  if (options_.seed) source.value[nlohmann::json::json_pointer(tool.seed_key)] = *options_.seed;
  config_name_ = source.name;
  config_ = resolved_config(source, schema_);
}

OutputOptions Session::output(const std::vector<std::string>& inputs) {
  if (options_.output_path.empty()) throw UsageError("-o/--output is required");
  claim_output("-o", options_.output_path, inputs);
  if (writes_hdf5_) require_hdf5_name(tool_, options_.output_path);
  claim_view(inputs);
  log("writes " + options_.output_path);
  return {options_.output_path, options_.overwrite, options_.compression};
}

void Session::require_output_for_view() const {
  if (!options_.view_path.empty() && options_.output_path.empty())
    throw UsageError("--view shows the output and needs -o");
}

void Session::claim_output(const std::string& option, const std::string& path,
                           const std::vector<std::string>& inputs) {
  if (path == "-")
    throw UsageError(option + " needs a file: " + (option == "-o" ? "this output" : "it") +
                     " cannot be written to standard output (./- is a file named -)");
  require_usable_output(path, options_.overwrite || (option == "-o" && CurrentOutputsAreKept::are_kept()));
  std::vector<std::string> named = inputs;
  add_named_files(config_, named);
  named.insert(named.end(), options_.config_names.begin(), options_.config_names.end());
  named.push_back(options_.log_path);
  for (const std::string& input : named)
    if (!input.empty() && input != "-" && same_file(path, input))
      throw UsageError("output " + path + " is an input of this run; name another file");
  for (const auto& [other, taken] : outputs_)
    if (same_file(path, taken)) throw UsageError(other + " and " + option + " name the same file, " + path);
  outputs_.emplace_back(option, path);
}

std::unique_ptr<OutputPath> Session::side_output(const std::string& option, const std::string& path,
                                                 const std::vector<std::string>& inputs) {
  if (path.empty()) return nullptr;
  claim_output(option, path, inputs);
  return std::make_unique<OutputPath>(path, options_.overwrite);
}

void Session::claim_view(const std::vector<std::string>& inputs) {
  const std::string& view = options_.view_path;
  if (view.empty()) return;
  if (file_extension(view) != ".png") throw UsageError("--view " + view + " is a picture; name a .png");
  for (const char* const other : {".tif", ".tiff", ".obj", ".ply"})
    if (file_extension(options_.output_path) == other)
      throw UsageError("--view shows an .h5 output, not " + options_.output_path);
  claim_output("--view", view, inputs);
}

void Session::view_output() {
  if (options_.view_path.empty()) return;
  phase("view", [this](const ProgressCallback& progress) {
    write_png({options_.view_path, options_.overwrite}, quick_look(options_.output_path, "", progress));
  });
}

Provenance Session::provenance() const {
  Provenance provenance;
  provenance.tool = tool_;
  provenance.config = config_;
  cut_paths(provenance.config);
  if (options_.record_environment) provenance.environment = environment_json(config_name_);
  return provenance;
}

void Session::with_file_names(const std::string& file, const std::function<void()>& work) const {
  try {
    work();
  } catch (const UsageError& error) {
    throw UsageError(config_name_ + ": /" + error.what() + " (" + file + ")");
  } catch (const FormatError& error) {
    throw FormatError(file + ": " + error.what());
  }
}

void Session::note(const std::string& text) {
  if (bar_ != nullptr) bar_->note(text);
}

double Session::phase(const std::string& name, const std::function<void(const ProgressCallback&)>& work) {
  const double wall = wall_seconds();
  const double cpu = cpu_seconds();
  const bool shown =
      host_ == nullptr && !options_.quiet && options_.progress.value_or(isatty(STDERR_FILENO) != 0);
  if (shown) {
    ProgressBar bar(name);
    bar_ = &bar;
    work([&bar](double fraction) { bar.update(fraction); });
    bar_ = nullptr;
    bar.finish();
  } else if (host_ != nullptr) {
    host_->progress(name, 0);
    work([&](double fraction) { host_->progress(name, fraction); });
  } else {
    work({});
  }
  const double wall_s = wall_seconds() - wall;
  phases_[name] = {{"wall_s", wall_s}, {"cpu_s", cpu_seconds() - cpu}};
  log(name + " took " + number_text(std::round(1e3 * wall_s) / 1e3) + " s");
  return wall_s;
}

double Session::elapsed_s() const { return wall_seconds() - start_s_; }

void Session::say(const std::string& text, bool shown) const {
  const std::string line = shown_text(tool_ + ": " + text);
  log_.write(line);
  if (shown && host_ == nullptr && !options_.quiet) std::cerr << line << '\n';
}

void Session::log(const std::string& line) const { say(line, options_.verbose); }

void Session::warn(const std::string& text) {
  warnings_.push_back(text);
  if (host_ != nullptr) host_->warn(text);
  say("warning: " + text, true);
}

void Session::conclude(const std::string& text, bool must_be_seen) const {
  say(text, must_be_seen || options_.verbose || isatty(STDERR_FILENO) != 0);
}

Json Session::summary() const {
  Json result = {{"tool", tool_},
                 {"phases", phases_},
                 {"wall_s", elapsed_s()},
                 {"cpu_s", cpu_seconds()},
                 {"peak_memory_bytes", peak_memory_bytes()},
                 {"threads", thread_count()},
                 {"warnings", warnings_}};
  result.update(counts_);
  return result;
}

}  // namespace landfall::cli
