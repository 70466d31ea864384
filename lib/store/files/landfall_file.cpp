// SPDX-License-Identifier: GPL-3.0-or-later
// Pipes and devices are refused as data, because readers seek in a file; a JSON configuration may come
// through one.
//
// `history` has no times, one line per step (CF recommends a time at its beginning), so that equal runs
// write equal files. It lists the last 200 steps; `/provenance/chain_json` lists all.
#include "store/files/landfall_file.h"

#include <algorithm>
#include <vector>

#include "base/core/error.h"
#include "base/text/file_path.h"
#include "base/text/shown_text.h"
#include "store/files/current_output.h"
#include "store/files/stored_json.h"
#include "store/hdf5/guard/file_seal.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/memory_file.h"

namespace landfall {
namespace {

/// A reader reads the versions up to its own major one.
std::string format_version(const std::string& kind) { return kind == "draws" ? "2.0" : "1.0"; }
constexpr const char* kIncomplete = "is incomplete (attribute complete is not 1)";

std::string title_of(const std::string& kind, const std::string& tool) {
  if (kind == "scan" && tool == "landfall-import") return "Points of another program";
  if (kind == "dem" && tool == "landfall-import") return "Digital elevation model of another program";
  if (kind == "terrain") return "True terrain of a landing site";
  if (kind == "scan") return "Simulated scanning-lidar returns";
  if (kind == "dem") return "Digital elevation model gridded from lidar returns";
  if (kind == "draws") return "Draws of a scan's errors";
  if (kind == "hazards") return "Landing hazards and sites";
  if (kind == "plan") return "Ground coverage that a scan would have on flat ground";
  return "Evaluation of a digital elevation model against landing requirements";
}

h5::Handle create_quietly(const std::filesystem::path& path) {
  h5::initialise();
  return h5::create_file(path);
}

/// Null in memory. Throws OutputIsCurrent.
std::unique_ptr<OutputPath> output_path(const OutputOptions& options, const std::string& kind,
                                        const Provenance& provenance) {
  if (h5::MemoryFile::find(options.path) != nullptr) return nullptr;
  leave_current(options.path, kind, provenance);
  return std::make_unique<OutputPath>(options.path, options.overwrite);
}

/// Seals a temporary file that is closed, and gives it its name.
void seal_and_commit(OutputPath& output, const std::vector<haddr_t>& objects) {
  try {
    h5::seal_file(output.temporary(), objects);
  } catch (const IoError& error) {
    throw IoError("output " + output.path().string() + ": " + error.what());
  }
  output.commit();
}

h5::Handle open_quietly(const std::string& path) {
  h5::initialise();
  return h5::open_file(path);
}

bool has_text(const nlohmann::json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string();
}

bool is_input_list(const nlohmann::json& inputs) {
  return inputs.is_array() && std::all_of(inputs.begin(), inputs.end(), [](const nlohmann::json& input) {
           return has_text(input, "role") && has_text(input, "file_id");
         });
}

/// Null if there is no such dataset or it is not JSON; throws FormatError if it exists but is not text.
nlohmann::json json_of(const std::string& file, hid_t provenance, const std::string& name) {
  const std::optional<std::string> text = h5::read_text(provenance, name);
  if (!text && h5::exists(provenance, name))
    throw FormatError(file + ": /provenance/" + name + " is not text");
  return stored_json<nlohmann::json>(text);
}

/// One line per step, oldest first, without a time, so that equal runs write equal files. An attribute holds
/// less than 64 KiB; the chain in /provenance is complete.
std::string history_of(const Provenance& provenance) {
  constexpr std::size_t kMaxSteps = 200;
  std::vector<nlohmann::json> steps(provenance.chain.begin(), provenance.chain.end());
  steps.push_back(provenance.as_step());
  std::string text;
  if (steps.size() > kMaxSteps) {
    text = std::to_string(steps.size() - kMaxSteps) + " earlier steps: /provenance/chain_json\n";
    steps.erase(steps.begin(), steps.end() - static_cast<std::ptrdiff_t>(kMaxSteps));
  }
  for (const nlohmann::json& step : steps) {
    const std::string version = step.value("version", "");
    text += "landfall " + shown_word(step.at("tool").get<std::string>()) + (version.empty() ? "" : " ") +
            shown_word(version) + ", file_id " + shown_word(step.at("file_id").get<std::string>()) + "\n";
  }
  text.pop_back();
  return text;
}

/// A foreign file's history is used only if all of it is understood.
bool is_history(const nlohmann::json& chain) {
  const auto is_step = [](const nlohmann::json& step) {
    return has_text(step, "tool") && has_text(step, "file_id") &&
           (!step.contains("version") || step["version"].is_string()) &&
           (!step.contains("inputs") || step["inputs"].is_null() || is_input_list(step["inputs"]));
  };
  return chain.is_array() && std::all_of(chain.begin(), chain.end(), is_step);
}

}  // namespace

LandfallFileWriter::LandfallFileWriter(const OutputOptions& options, const std::string& kind,
                                       const Provenance& provenance)
    : output_(output_path(options, kind, provenance)),
      kind_(kind),
      compression_(output_ ? options.compression : h5::kPlain),
      file_(create_quietly(output_ ? output_->temporary() : options.path)) {
  h5::write_attribute(root(), "title", title_of(kind, provenance.tool));
  h5::write_attribute(root(), "source", source_line(provenance.tool));
  h5::write_attribute(root(), "history", history_of(provenance));
  h5::write_attribute(root(), "format_name", "landfall." + kind);
  h5::write_attribute(root(), "format_version", format_version(kind));
  h5::write_attribute(root(), "file_id", provenance.file_id());
  const h5::Handle group = h5::create_group(root(), "provenance");
  h5::write_attribute(group.get(), "tool", provenance.tool);
  h5::write_attribute(group.get(), "version", program_version());
  h5::write_text(group.get(), {"config_json", "resolved configuration"}, provenance.config.dump(2));
  if (!provenance.options.is_null())
    h5::write_text(group.get(), {"options_json", "options that change the content"},
                   provenance.options.dump(2));
  h5::write_text(group.get(), {"inputs_json", "files that were read, and their ids"},
                 provenance.as_step().at("inputs").dump(2));
  h5::write_text(group.get(), {"chain_json", "upstream steps, oldest first"}, provenance.chain.dump(2));
  if (!provenance.environment.is_null())
    h5::write_text(group.get(), {"environment_json", "host, time and folder of the run"},
                   provenance.environment.dump(2));
}

void LandfallFileWriter::commit() {
  if (follows_cf_) h5::write_attribute(root(), "Conventions", std::string("CF-1.8"));
  h5::write_attribute(root(), "complete", std::int64_t{1});
  if (!output_) {
    if (const std::optional<std::string> failure = h5::close_file(file_)) throw IoError(*failure);
    return;
  }
  const std::vector<haddr_t> objects = h5::object_addresses(root());
  if (const std::optional<std::string> failure = h5::close_file(file_))
    throw IoError("output " + output_->path().string() + ": closing failed: " + *failure);
  seal_and_commit(*output_, objects);
}

void save_file(h5::MemoryFile& file, const OutputOptions& options) {
  OutputPath output(options.path, options.overwrite);
  write_text(output, file.image());
  file.save_arrays(output.temporary());
  const std::vector<haddr_t> objects = h5::object_addresses(open_quietly(output.temporary()).get());
  seal_and_commit(output, objects);
}

void check_file(const std::filesystem::path& path) {
  const h5::Handle file = open_quietly(path.string());
  if (h5::read_text_attribute(file.get(), "format_name") != "landfall.results")
    static_cast<void>(LandfallFileReader(path, kLandfallKinds));
  else if (h5::read_number_attribute(file.get(), "complete").value_or(0) != 1)
    throw FormatError(path.string() + ": " + kIncomplete);
}

void add_seal(const std::filesystem::path& path) {
  check_file(path);
  if (h5::has_seal(path)) return;
  const std::vector<haddr_t> objects = h5::object_addresses(open_quietly(path.string()).get());
  try {
    h5::seal_file(path, objects);
  } catch (const IoError& error) {
    throw IoError(path.string() + ": cannot be sealed: " + error.what());
  }
}

LandfallFileReader::LandfallFileReader(const std::filesystem::path& path,
                                       std::initializer_list<const char*> kinds)
    : name_(path.string()), file_(open_quietly(name_)) {
  const auto format = h5::read_text_attribute(root(), "format_name");
  std::string wanted;
  for (const char* const kind : kinds)
    wanted += (wanted.empty() ? "landfall." : " or landfall.") + std::string(kind);
  if (!format) fail("is not a landfall file (it has no attribute format_name); expected " + wanted);
  const auto matches = [&](const char* kind) { return *format == "landfall." + std::string(kind); };
  if (std::none_of(kinds.begin(), kinds.end(), matches))
    fail("is a " + shown_word(*format) + " file; expected " + wanted);
  const std::string version = h5::read_text_attribute(root(), "format_version").value_or("");
  const char newest = format_version(format->substr(std::string_view("landfall.").size())).front();
  if (version.size() < 2 || version[0] < '1' || version[0] > newest || version[1] != '.')
    fail("format_version '" + shown_word(version) + "' is not 1.x" + (newest == '2' ? " or 2.x" : "") +
         ", which this version reads");
  format_major_ = version[0] - '0';
  if (h5::read_number_attribute(root(), "complete").value_or(0) != 1) fail(kIncomplete);
  read_provenance();
}

void LandfallFileReader::read_provenance() {
  file_id_ = h5::read_text_attribute(root(), "file_id").value_or("");
  if (file_id_.empty()) file_id_ = content_id(name_);
  const h5::Handle group = h5::open_group(root(), "provenance");
  if (!group) return;
  nlohmann::json config = json_of(name_, group.get(), "config_json");
  if (config.is_object()) config_ = std::move(config);
  nlohmann::json upstream = json_of(name_, group.get(), "chain_json");
  if (is_history(upstream)) chain_ = std::move(upstream);
  nlohmann::json inputs = json_of(name_, group.get(), "inputs_json");
  if (!is_input_list(inputs)) inputs = nullptr;
  nlohmann::json step = {{"tool", h5::read_text_attribute(group.get(), "tool").value_or("")},
                         {"version", h5::read_text_attribute(group.get(), "version").value_or("")},
                         {"file_id", file_id_},
                         {"config", config_},
                         {"inputs", std::move(inputs)}};
  const nlohmann::json options = json_of(name_, group.get(), "options_json");
  if (!options.is_null()) step["options"] = options;
  chain_.push_back(step);
}

void LandfallFileReader::fail(const std::string& what) const { throw FormatError(name_ + ": " + what); }

bool is_landfall_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(status_of(path))) return false;
  h5::initialise();
  const h5::Handle file = h5::open_for_its_kind(path);
  return file && h5::read_text_attribute(file.get(), "format_name").value_or("").starts_with("landfall.");
}

}  // namespace landfall
