// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/tool.h"

#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <iostream>
#include <memory>
#include <new>

#include "base/abbreviated.h"
#include "base/file_extension.h"
#include "base/number_text.h"
#include "base/parallel.h"
#include "base/thread_supply.h"
#include "base/utf8.h"
#include "cli/command_line.h"
#include "cli/completion.h"
#include "cli/config_changes.h"
#include "cli/manual.h"
#include "cli/option_view.h"
#include "cli/page_width.h"
#include "cli/print.h"
#include "cli/progress_bar.h"
#include "cli/run_log.h"
#include "cli/standard_streams.h"
#include "config/presets.h"
#include "config/schema.h"
#include "exports/quick_look.h"
#include "output/temporary_files.h"
#include "picture/png.h"

namespace landfall::cli {
namespace {

using Json = nlohmann::json;

/// Installed before other objects of file scope are constructed, because these may already run out of memory;
/// uses the name by which the program was called.
struct EarlyMemoryCleanup {
  EarlyMemoryCleanup() { install_memory_cleanup(program_invocation_short_name); }
};
const EarlyMemoryCleanup early_memory_cleanup __attribute__((init_priority(101)));

/// The configuration keys that name files.
constexpr std::array kPathKeys = {"path", "table"};

/// Removes folders from paths: messages and files must not reveal the machine's folders.
void cut_paths(Json& value) {
  for (const char* const key : kPathKeys)
    if (value.is_object() && value.contains(key) && value[key].is_string())
      value[key] = std::filesystem::path(value[key].get<std::string>()).filename().string();
  if (value.is_structured())
    for (Json& element : value) cut_paths(element);
}

/// Adds the files that a configuration names.
void add_named_files(const Json& value, std::vector<std::string>& files) {
  for (const char* const key : kPathKeys)
    if (value.is_object() && value.contains(key) && value[key].is_string())
      files.push_back(value[key].get<std::string>());
  if (value.is_structured())
    for (const Json& element : value) add_named_files(element, files);
}

/// The formats of other programs that the extension of an output may name.
constexpr std::array kForeignExtensions = {
    ".asc", ".csv", ".e57", ".gz",  ".html", ".img", ".jpeg", ".jpg", ".json", ".las", ".laz", ".obj",
    ".off", ".pcd", ".ply", ".png", ".stl",  ".tif", ".tiff", ".txt", ".vrt",  ".xmf", ".xyz", ".zip"};
/// Those that landfall-export writes.
constexpr std::array kExportedExtensions = {".csv", ".las", ".ply", ".png", ".tif", ".tiff", ".xmf"};

/// A tool that writes HDF5 would give the file a name that other programs misunderstand.
void require_hdf5_name(const std::string& tool, const std::string& path) {
  const std::string extension = file_extension(path);
  if (std::ranges::find(kForeignExtensions, extension) == kForeignExtensions.end()) return;
  const std::string own = std::filesystem::path(path).replace_extension(".h5").string();
  std::string message = "output " + path + ": " + tool + " writes HDF5; name it " + own;
  if (std::ranges::find(kExportedExtensions, extension) != kExportedExtensions.end())
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

/// Fails if stdout could not be written, so that a reader does not mistake partial output for the whole.
void flush_stdout() {
  std::cout.flush();
  if (!std::cout) throw IoError("writing to standard output failed");
}

// The groups in which help and man page list the options; a tool's own are in CLI11's "Options".
constexpr const char* kConfiguration = "Configuration";
constexpr const char* kOutput = "Output";
constexpr const char* kGeneral = "General";
constexpr const char* kHidden = "";

void bind_config(CLI::App& app, CommonOptions& o, const Tool& tool) {
  const bool has_presets = !presets(tool.schema).empty();
  app.add_option("-c,--config", o.config_names,
                 std::string("JSON configuration, comments allowed: a file") +
                     (has_presets ? ", - (standard input) or preset:NAME" : " or - (standard input)") +
                     "; repeatable, merged in order")
      ->type_name("FILE")
      ->expected(1)
      ->allow_extra_args(false)  // the next argument is the input file, not a second value
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kConfiguration);
  if (has_presets)
    app.add_flag("--list-presets", o.list_presets, "List the presets of -c preset:NAME and exit")
        ->group(kConfiguration);
  app.add_option("--set", o.assignments,
                 "Set a configuration value, a.b.c=JSON; repeatable, overrides the file")
      ->type_name("KEY=JSON")
      ->expected(1)
      ->allow_extra_args(false)  // the next argument is the input file, not a second value
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->group(kConfiguration);
  if (tool.has_seed)
    app.add_option("--seed", o.seed, "Random seed; overrides the configuration")
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9007199254740991}))
        ->group(kConfiguration);
  app.add_flag("--check", o.check_only,
               "Validate the configuration and exit; data files that it names are not read")
      ->group(kConfiguration);
  app.add_flag("--print-config", o.print_config, "Print the resolved configuration and exit")
      ->group(kConfiguration);
  app.add_flag("--print-schema", o.print_schema,
               "Print the JSON schema of the configuration, with a description of every key, and exit")
      ->group(kConfiguration);
}

void bind_output(CLI::App& app, CommonOptions& o) {
  app.add_option("-o,--output", o.output_path, "Output file")->type_name("FILE")->group(kOutput);
  app.add_flag("-O,--overwrite", o.overwrite, "Replace an existing output")->group(kOutput);
  app.add_option("--compression", o.compression, "Deflate level of the output; 0: no compression")
      ->type_name("0..9")
      ->check(CLI::Range(0, 9))
      ->capture_default_str()
      ->group(kOutput);
  app.add_flag("--json", o.json_summary, "Print a JSON summary of the run to stdout: times, counts, memory")
      ->group(kOutput);
}

void bind_general(CLI::App& app, CommonOptions& o, const Tool& tool) {
  app.add_option("-t,--threads", o.threads, "Number of threads; 0: all cores")
      ->type_name("N")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str()
      ->group(kGeneral);
  app.add_flag("-q,--quiet", o.quiet, "Errors only: no progress, no warnings")->group(kGeneral);
  app.add_flag("-v,--verbose", o.verbose, "Log each phase to stderr")->group(kGeneral);
  app.add_option("--log", o.log_path, "Append all messages of the run to this file, also those that -q omits")
      ->type_name("FILE")
      ->group(kGeneral);
  // A function, because CLI11 sets a flag bound to an optional to false if it is not given.
  app.add_flag_function(
         "--progress,!--no-progress", [&o](std::int64_t count) { o.progress = count > 0; },
         "Show progress; default: only if stderr is a terminal")
      ->group(kGeneral);
  app.set_version_flag("-V,--version", source_line(tool.name), "Print the version and exit")->group(kGeneral);
  // Declared again, because CLI11 declares its own help flag before all others.
  app.set_help_flag("-h,--help", "Print this help and exit")->group(kGeneral);
  app.add_flag("--print-man", o.print_man, "Print the man page and exit")->group(kHidden);
  app.add_flag("--print-completion", o.print_completion, "Print the bash completion and exit")
      ->group(kHidden);
}

void bind_common(CLI::App& app, CommonOptions& o, const Tool& tool) {
  if (!tool.schema.empty()) bind_config(app, o, tool);
  if (tool.writes) bind_output(app, o);
  if (tool.writes && !tool.schema.empty()) {
    app.add_option("--view", o.view_path, "Also write a picture of the output (.png)")
        ->type_name("FILE")
        ->group(kOutput);
    app.add_flag("--record-environment", o.record_environment,
                 "Record host, time and directory in the output")
        ->group(kOutput);
  }
  bind_general(app, o, tool);
}

/// Adds the output's name to a write error: the lower layers know only the dataset.
ExitCode run_naming_output(const Tool& tool, Session& session) {
  try {
    return tool.run(session);
  } catch (const IoError& error) {
    const std::string what = error.what();
    const std::string& path = session.options().output_path;
    if (path.empty() || path == "-" || what.starts_with("output ")) throw;
    throw IoError("output " + path + ": " + what);
  }
}

std::string preset_list(const std::string& schema) {
  std::string text;
  for (const Preset& preset : presets(schema))
    text += print("%-20s ", preset.name.c_str()) + preset.description + "\n";
  return text;
}

ExitCode run_tool(const Tool& tool, const CommonOptions& options, RunLog& log) {
  if (options.print_schema || options.list_presets) {
    std::cout << (options.print_schema ? embedded_schema(tool.schema).dump(2) + "\n"
                                       : preset_list(tool.schema));
    return ExitCode::done;
  }
  Session session(tool, options, log);
  if (!tool.schema.empty()) {
    session.resolve_config(tool);
    tool.check(session);
  }
  if (options.print_config) std::cout << session.config().dump(2) << '\n';
  if (options.print_config || options.check_only) return ExitCode::done;
  // Never destroyed: removing the limit would make oneTBB start threads that are no longer needed. Volatile,
  // so that the compiler keeps the pointer and leak checkers find the object reachable.
  static const ThreadLimit* volatile const limit = new ThreadLimit(options.threads);
  static_cast<void>(limit);
  install_signal_cleanup(tool.name);
  session.require_output_for_view();
  const ExitCode code = run_naming_output(tool, session);
  session.view_output();
  if (options.json_summary) std::cout << session.summary().dump(2) << '\n';
  return code;
}

/// Any argument may end up in JSON: in the configuration, in provenance, in a summary.
void require_utf8(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i)
    if (!is_utf8(argv[i]))
      throw UsageError("argument " + std::to_string(i) + ", '" + shown_word(argv[i]) +
                       "', is not UTF-8; file names and texts must be UTF-8");
}

/// A key and its value in two arguments would be read as a key without a value.
void require_assignments(int argc, const char* const* argv) {
  for (int i = 1; i + 1 < argc; ++i) {
    const std::string key = argv[i + 1];
    if (std::string_view(argv[i]) != "--set" || key.empty() || key.find('=') != std::string::npos) continue;
    const std::string_view next = i + 2 < argc ? argv[i + 2] : "-";
    const bool is_value =
        next.size() > 1 ? next[0] != '-' || (next[1] >= '0' && next[1] <= '9') : next != "-";
    throw UsageError("--set " + abbreviated(key) + ": expected KEY=JSON" +
                     (is_value ? "; write --set " + abbreviated(key + "=" + std::string(next)) : ""));
  }
}

/// The command of a run, for its log.
std::string command_line(int argc, const char* const* argv, const Tool& tool) {
  std::string line = "$ " + tool.name;
  for (int i = 1; i < argc; ++i) line += std::string(" ") + argv[i];
  return line;
}

ExitCode parse_and_run(CLI::App& app, int argc, const char* const* argv, const Tool& tool,
                       const CommonOptions& options, RunLog& log) {
  require_utf8(argc, argv);
  if (!tool.schema.empty()) require_assignments(argc, argv);
  try {
    app.parse(argc, argv);
    require_values(app);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return ExitCode::done;
  } catch (const CLI::CallForVersion&) {
    std::cout << source_line(tool.name) << '\n';
    return ExitCode::done;
  }
  if (options.print_man || options.print_completion) {
    std::cout << (options.print_man ? manual_page(app, tool) : bash_completion(app, tool));
    return ExitCode::done;
  }
  if (!options.log_path.empty()) {
    log.open(options.log_path);
    log.write(command_line(argc, argv, tool));
  }
  return run_tool(tool, options, log);
}

/// " (--half-width)", the tool's option for the parameter half_width_m; empty if there is no such option.
std::string option_hint(const CLI::App& app, const Error& error) {
  std::string option = std::string("--") + error.parameter();
  std::replace(option.begin(), option.end(), '_', '-');
  while (option.size() > 2 && app.get_option_no_throw(option) == nullptr)
    option.resize(option.rfind('-'));  // removes the unit, if any
  return option.size() > 2 ? " (" + option + ")" : "";
}

/// One line, even if a file name or a key contains line breaks.
std::string one_line(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = '?';
  return text;
}

}  // namespace

Session::Session(const Tool& tool, const CommonOptions& options, RunLog& log)
    : tool_(tool.name),
      schema_(tool.schema),
      options_(options),
      log_(log),
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
  if (options_.seed) source.value["seed"] = *options_.seed;
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
  require_usable_output(path, options_.overwrite);
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

void Session::name_misfit(const std::string& file, const std::function<void()>& work) const {
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
  const bool shown = !options_.quiet && options_.progress.value_or(isatty(STDERR_FILENO) != 0);
  if (shown) {
    ProgressBar bar(name);
    bar_ = &bar;
    work([&bar](double fraction) { bar.update(fraction); });
    bar_ = nullptr;
    bar.finish();
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
  const std::string line = one_line(tool_ + ": " + text);
  log_.write(line);
  if (shown && !options_.quiet) std::cerr << line << '\n';
}

void Session::log(const std::string& line) const { say(line, options_.verbose); }

void Session::warn(const std::string& text) {
  warnings_.push_back(text);
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

int tool_main(int argc, const char* const* argv, const Tool& tool) {
  hold_closed_standard_streams();
  CLI::App app(tool.summary, tool.name);
  CommonOptions options;
  RunLog log;
  const auto fail = [&](const std::string& message, ExitCode code) {
    const std::string line = one_line(tool.name + ": " + message);
    log.write(line);
    std::cerr << line << '\n';
    return static_cast<int>(code);
  };
  set_help_format(app);
  app.footer(tool.examples);
  tool.bind(app);
  bind_common(app, options, tool);
  try {
    const ExitCode code = parse_and_run(app, argc, argv, tool, options, log);
    flush_stdout();
    return static_cast<int>(code);
  } catch (const CLI::ParseError& error) {
    return fail(plain_message(app, error) + " (see --help)", ExitCode::usage);
  } catch (const Error& error) {
    return fail(error.what() + option_hint(app, error), error.exit_code());
  } catch (const std::bad_alloc&) {
    return fail("not enough memory for this run", ExitCode::data_failed);
  } catch (const std::exception& error) {
    if (is_thread_refusal(error))
      return fail("the system gives no further thread: allow more threads or memory, or use -t 1",
                  ExitCode::data_failed);
    return fail(std::string("internal error, please report it: ") + error.what(), ExitCode::data_failed);
  }
}

}  // namespace landfall::cli
