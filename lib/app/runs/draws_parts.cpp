// SPDX-License-Identifier: GPL-3.0-or-later
// Sums of a part are checked before they are added: counts against the number of its draws, sums against
// the largest error that is summed (D314), so that an edited file cannot overflow them. Samples have at
// most as many rows as `draws` allows.
#include "app/runs/draws_parts.h"

#include <malloc.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "base/core/error.h"
#include "store/config/schema.h"
#include "store/files/draws_verdict.h"

namespace landfall {
namespace {

/// The option that says which draws a part has.
constexpr const char* kPart = "draws";

/// A part's step in its own history, without what differs between parts.
nlohmann::json undivided_step(const DrawsInput& part) {
  nlohmann::json step = part.chain.back();
  if (step.contains("options") && step["options"].is_object()) step["options"].erase(kPart);
  if (step.contains("options") && step["options"].empty()) step.erase("options");
  step.erase("file_id");
  return step;
}

struct Part {
  std::string path;
  DrawsInput input;
  [[nodiscard]] const DrawTable& table() const { return input.draws.table; }
};

std::string range_text(const Part& part) {
  return part.path + " (draws " + std::to_string(part.table().first) + ":" +
         std::to_string(part.table().end()) + ")";
}

std::string counted_seeds_text(const std::string& path) {
  return path + ": is of version 0.2.0, whose draws have other random numbers than those of this version; ";
}

void require_same_draws(const std::vector<Part>& parts) {
  for (const Part& part : parts)
    if (part.input.counts_seeds)
      throw UsageError(counted_seeds_text(part.path) + "merge its parts with that version");
  for (std::size_t i = 1; i < parts.size(); ++i)
    if (undivided_step(parts[i].input) != undivided_step(parts[0].input))
      throw UsageError(parts[i].path + ": is not a part of the same run as " + parts[0].path +
                       ": its version, configuration or inputs differ");
}

bool same_columns(const std::vector<DrawColumn>& a, const std::vector<DrawColumn>& b) {
  return std::ranges::equal(a, b, {}, &DrawColumn::name, &DrawColumn::name);
}

/// The files of one run of draws have the same columns and grid, unless they were edited.
void require_same_contents(const std::vector<Part>& parts) {
  const Draws& first = parts.front().input.draws;
  for (const Part& part : parts) {
    const Draws& draws = part.input.draws;
    if (!same_columns(draws.table.varied, first.table.varied) ||
        !same_columns(draws.table.metrics, first.table.metrics) ||
        draws.maps.has_value() != first.maps.has_value() ||
        (draws.maps && (draws.maps->spec() != first.maps->spec() ||
                        draws.maps->safety.has_value() != first.maps->safety.has_value())))
      throw FormatError(part.path + ": its columns or its grid are not those of " + parts.front().path);
  }
}

/// The configuration of the run of draws with all its keys.
nlohmann::json config_of(const Part& part) {
  try {
    return resolve_config({part.path, part.input.chain.back().at("config")}, embedded_schema("draws"));
  } catch (const UsageError& error) {
    throw FormatError(part.path +
                      ": /provenance/config_json is not a configuration of draws: " + error.what());
  }
}

/// The parts in order must be draws 0 .. count - 1.
void require_whole(const std::vector<Part>& parts, std::int64_t count) {
  if (parts.front().table().first != 0)
    throw UsageError(range_text(parts.front()) + ": draws 0:" + std::to_string(parts.front().table().first) +
                     " are missing");
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const std::int64_t before = parts[i - 1].table().end();
    const std::int64_t first = parts[i].table().first;
    if (first < before) throw UsageError(range_text(parts[i]) + ": overlaps " + range_text(parts[i - 1]));
    if (first > before)
      throw UsageError(range_text(parts[i]) + ": draws " + std::to_string(before) + ":" +
                       std::to_string(first) + " are missing");
  }
  if (const std::int64_t end = parts.back().table().end(); end != count)
    throw UsageError(range_text(parts.back()) + ": draws " + std::to_string(end) + ":" +
                     std::to_string(count) + " are missing");
}

}  // namespace

DrawsState::DrawsState(const std::filesystem::path& output, Provenance provenance, std::int64_t first)
    : path_(hidden_beside(output, "state")), provenance_(std::move(provenance)), first_(first) {}

Provenance DrawsState::provenance_of(const DrawTable& table) const {
  Provenance provenance = provenance_;
  provenance.options.update(part_options(table.first, table.end()));
  return provenance;
}

std::optional<Draws> DrawsState::load(const std::function<void(const std::string&)>& warn) const {
  {
    const OutputPath killed(path_, true);
  }  // removes the temporary file of a run that was killed while it wrote a state
  if (!std::filesystem::exists(path_)) return std::nullopt;
  try {
    DrawsInput input = read_draws(path_);
    if (input.counts_seeds)
      throw UsageError(counted_seeds_text(path_.string()) + "finish that run with it, or remove the file");
    if (input.draws.table.first == first_ && input.file_id == provenance_of(input.draws.table).file_id())
      return std::move(input.draws);
    warn(path_.string() + ": belongs to another run and is not used");
  } catch (const UsageError&) {
    throw;
  } catch (const Error& error) {
    warn(std::string(error.what()) + "; the run begins again");
  }
  return std::nullopt;
}

void DrawsState::save(const Draws& draws, const std::string& crs_wkt) const {
  {
    LandfallFileWriter file({path_, true, 1}, "draws", provenance_of(draws.table));
    write_draws(file, draws, verdict_json(draws.table, std::nullopt), crs_wkt);
  }
  malloc_trim(0);  // the heap would keep the buffers of the writer, 60 MB, while draws are made
}

void DrawsState::remove() const noexcept {
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

nlohmann::json part_options(std::int64_t first, std::int64_t end) {
  return {{kPart, std::to_string(first) + ":" + std::to_string(end)}};
}

MergedDraws merge_draws(const std::vector<std::string>& paths, Provenance& provenance) {
  std::vector<Part> parts;
  for (const std::string& path : paths) parts.push_back({path, read_draws(path)});
  std::ranges::stable_sort(parts, {}, [](const Part& part) { return part.table().first; });
  require_same_draws(parts);
  require_same_contents(parts);
  const nlohmann::json& step = parts.front().input.chain.back();
  const nlohmann::json config = config_of(parts.front());
  provenance.config = step.at("config");
  if (const nlohmann::json whole = undivided_step(parts.front().input); whole.contains("options"))
    provenance.options = whole.at("options");
  if (config.at("stop").at("type") != "fixed")
    throw UsageError(paths.front() + ": a run with a sequential test has no parts");
  const auto scans = std::ranges::count(step.at("inputs"), "scan", [](const nlohmann::json& input) {
    return input.at("role").get<std::string>();
  });
  require_whole(parts, std::max<std::int64_t>(scans, 1) * config.at("draws").get<std::int64_t>());
  for (const nlohmann::json& input : step.at("inputs"))
    provenance.inputs.push_back({input.at("role"), input.at("file_id")});
  provenance.chain = parts.front().input.chain;
  provenance.chain.erase(provenance.chain.size() - 1);
  MergedDraws merged{std::move(parts.front().input.draws), parts.front().input.crs_wkt};
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const Draws& next = parts[i].input.draws;
    append(merged.draws.table, next.table);
    if (merged.draws.maps) merged.draws.maps->merge(*next.maps);
  }
  return merged;
}

}  // namespace landfall
