// SPDX-License-Identifier: GPL-3.0-or-later
// Scope of `--check`: everything that the configuration alone determines, including features that stand
// off the grid. It opens no data file, so that it works on a machine that does not have them.
#include "app/cli/tool.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <new>

#include "app/cli/command_line.h"
#include "app/cli/completion.h"
#include "app/cli/manual.h"
#include "app/cli/option_view.h"
#include "app/cli/print.h"
#include "app/cli/run_log.h"
#include "base/core/parallel.h"
#include "base/core/standard_streams.h"
#include "base/dictionary/tables/tools.h"
#include "base/output/temporary_files.h"
#include "base/text/json_text.h"
#include "base/text/shown_text.h"
#include "store/config/presets.h"
#include "store/config/schema.h"
#include "store/files/current_output.h"

namespace landfall::cli {
namespace {

/// Installed before other objects of file scope are constructed, because these may already run out of memory;
/// uses the name by which the program was called.
struct EarlyMemoryCleanup {
  EarlyMemoryCleanup() { install_memory_cleanup(program_invocation_short_name); }
};
const EarlyMemoryCleanup early_memory_cleanup __attribute__((init_priority(101)));

/// Fails if stdout could not be written, so that a reader does not mistake partial output for the whole.
void flush_stdout() {
  if (!standard_output().flush()) throw IoError("writing to standard output failed");
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
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (has_presets)
    app.add_flag("--list-presets", o.list_presets, "List the presets of -c preset:NAME and exit");
  app.add_option("--set", o.assignments,
                 "Set a configuration value, a.b.c=JSON; repeatable, overrides the file")
      ->type_name("KEY=JSON")
      ->expected(1)
      ->allow_extra_args(false)  // the next argument is the input file, not a second value
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  if (tool.has_seed)
    app.add_option("--seed", o.seed, "Random seed; overrides the configuration")
        ->type_name("N")
        ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{9007199254740991}));
  app.add_flag("--check", o.check_only,
               "Validate the configuration and exit; data files that it names are not read");
  app.add_flag("--print-config", o.print_config, "Print the resolved configuration and exit");
  app.add_flag("--print-schema", o.print_schema,
               "Print the JSON schema of the configuration, with a description of every key, and exit");
}

void bind_overwrite(CLI::App& app, CommonOptions& o, const Tool& tool) {
  app.add_flag("-O,--overwrite", o.overwrite,
               tool.writes_folder ? "Replace files of the outputs' names, whatever they are"
                                  : "Replace an existing output");
}

void bind_output(CLI::App& app, CommonOptions& o, const Tool& tool) {
  app.add_option("-o,--output", o.output_path,
                 tool.writes_folder ? "Folder of the outputs; made if it does not exist" : "Output file")
      ->type_name(tool.writes_folder ? "DIR" : "FILE");
  bind_overwrite(app, o, tool);
  app.add_option("--compression", o.compression, "Deflate level of the output; 0: no compression")
      ->type_name("0..9")
      ->check(CLI::Range(0, 9))
      ->capture_default_str();
  app.add_flag("--json", o.json_summary, "Print a JSON summary of the run to stdout: times, counts, memory");
}

void bind_general(CLI::App& app, CommonOptions& o, const Tool& tool) {
  app.add_option("-t,--threads", o.threads, "Number of threads; 0: all cores")
      ->type_name("N")
      ->check(CLI::Range(0, 4096))
      ->capture_default_str();
  app.add_flag("-q,--quiet", o.quiet, "Errors only: no progress, no warnings");
  app.add_flag("-v,--verbose", o.verbose, "Log each phase to stderr");
  app.add_option("--log", o.log_path, "Append all messages of the run to this file, also those that -q omits")
      ->type_name("FILE");
  // A function, because CLI11 sets a flag bound to an optional to false if it is not given.
  app.add_flag_function(
      "--progress,!--no-progress", [&o](std::int64_t count) { o.progress = count > 0; },
      "Show progress; default: only if stderr is a terminal");
  app.set_version_flag("-V,--version", source_line(tool.name), "Print the version and exit");
  // Declared again, because CLI11 declares its own help flag before all others.
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.add_flag("--print-man", o.print_man, "Print the man page and exit")->group(kHidden);
  app.add_flag("--print-completion", o.print_completion, "Print the bash completion and exit")
      ->group(kHidden);
}

void bind_common(CLI::App& app, CommonOptions& o, const Tool& tool) {
  app.option_defaults()->group(kConfiguration);
  if (!tool.schema.empty()) bind_config(app, o, tool);
  app.option_defaults()->group(kOutput);
  if (tool.writes) bind_output(app, o, tool);
  if (tool.writes_side_file) bind_overwrite(app, o, tool);
  if (tool.writes && !tool.schema.empty()) {
    if (!tool.writes_folder)
      app.add_option("--view", o.view_path, "Also write a picture of the output (.png)")->type_name("FILE");
    app.add_flag("--record-environment", o.record_environment,
                 "Record host, time and directory in the output");
  }
  app.option_defaults()->group(kGeneral);
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

/// The work, on the threads that are asked for.
ExitCode run_session(const Tool& tool, Session& session) {
  session.require_output_for_view();
  const ExitCode code = run_naming_output(tool, session);
  session.view_output();
  if (session.options().json_summary) standard_output() << shown_lines(session.summary().dump(2)) << '\n';
  return code;
}

ExitCode run_tool(const Tool& tool, const CommonOptions& options, RunLog& log, const Host* host) {
  if (options.print_schema || options.list_presets) {
    standard_output() << (options.print_schema ? printed_schema(tool.schema) : preset_list(tool.schema));
    return ExitCode::done;
  }
  Session session(tool, options, log, host);
  if (!tool.schema.empty()) {
    session.resolve_config(tool);
    tool.check(session);
  }
  if (options.print_config) standard_output() << shown_lines(session.config().dump(2)) << '\n';
  if (options.print_config || options.check_only) return ExitCode::done;
  if (host != nullptr) {
    const ThreadLimit limit(options.threads);
    return run_session(tool, session);
  }
  // Never destroyed: removing the limit would make oneTBB start threads that are no longer needed. Volatile,
  // so that the compiler keeps the pointer and leak checkers find the object reachable.
  static const ThreadLimit* volatile const limit = new ThreadLimit(options.threads);
  static_cast<void>(limit);
  install_signal_cleanup(tool.name);
  return run_session(tool, session);
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
                       const CommonOptions& options, RunLog& log, const Host* host) {
  require_utf8(argc, argv);
  if (!tool.schema.empty()) require_assignments(argc, argv);
  try {
    app.parse(argc, argv);
    require_values(app);
  } catch (const CLI::CallForHelp&) {
    standard_output() << app.help();
    return ExitCode::done;
  } catch (const CLI::CallForVersion&) {
    standard_output() << source_line(tool.name) << '\n';
    return ExitCode::done;
  }
  if (options.print_man || options.print_completion) {
    standard_output() << (options.print_man ? manual_page(app, tool) : bash_completion(app, tool));
    return ExitCode::done;
  }
  if (!options.log_path.empty()) {
    log.open(options.log_path);
    log.write(command_line(argc, argv, tool));
  }
  return run_tool(tool, options, log, host);
}

/// " (--half-width)", the tool's option for the parameter half_width_m; empty if there is no such option.
std::string option_hint(const CLI::App& app, const Error& error) {
  std::string option = std::string("--") + error.parameter();
  std::replace(option.begin(), option.end(), '_', '-');
  while (option.size() > 2 && app.get_option_no_throw(option) == nullptr)
    option.resize(option.rfind('-'));  // removes the unit, if any
  return option.size() > 2 ? " (" + option + ")" : "";
}

}  // namespace

Tool::Tool(std::string known_name) : name(std::move(known_name)) {
  const dictionary::Tool& words = *std::ranges::find(dictionary::kTools, name, &dictionary::Tool::name);
  summary = words.summary;
  schema = words.schema;
  exit_3 = words.exit_3;
  plugin = words.plugin;
}

int tool_main(int argc, const char* const* argv, const Tool& tool, Invocation* invocation) {
  const Host* const host = invocation != nullptr ? invocation->host : nullptr;
  if (host == nullptr) hold_closed_standard_streams();
  CLI::App app(tool.summary, tool.name);
  CommonOptions options;
  if (invocation != nullptr) options.section = invocation->section;
  RunLog log;
  const auto fail = [&](const std::string& message, ExitCode code) {
    constexpr std::string_view kSet = "config: ";  // the keys of --set
    const bool has_section =
        invocation != nullptr && !invocation->section.empty() && message.starts_with("config: /");
    const std::string text = has_section ? invocation->section + message.substr(kSet.size()) : message;
    const std::string line = shown_text(tool.name + ": " + text);
    log.write(line);
    if (host != nullptr)
      host->fail(text);
    else
      std::cerr << line << '\n';
    return static_cast<int>(code);
  };
  set_help_format(app);
  app.footer(tool.examples);
  tool.bind(app);
  bind_common(app, options, tool);
  const CurrentOutputsAreKept kept(invocation != nullptr && invocation->keep_same);
  try {
    const ExitCode code = parse_and_run(app, argc, argv, tool, options, log, host);
    flush_stdout();
    return static_cast<int>(code);
  } catch (const OutputIsCurrent&) {
    invocation->kept = true;
    return static_cast<int>(ExitCode::done);
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
