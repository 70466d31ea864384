// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/redraw.h"

#include <optional>

#include "base/core/error.h"
#include "base/text/shown_text.h"
#include "store/config/key_effects.h"

namespace landfall {
namespace {

using Json = nlohmann::json;

/// The value at a path such as /noise/dropout_frac, null if it does not exist: a foreign file's configuration
/// may have any structure.
Json value_at(const Json& config, const std::string& path) {
  const Json::json_pointer where(path);
  return config.contains(where) ? config.at(where) : Json();
}

/// A key with different values; null stands for a missing one.
struct Difference {
  std::string where;  ///< "/detector/rows"
  Json theirs;
  Json ours;

  [[nodiscard]] std::string text() const {
    const auto shown = [](const Json& value) {
      return value.is_null() ? std::string("none") : abbreviated(value.dump());
    };
    return where + " differs: " + shown(theirs) + " in the scan, " + shown(ours) + " in this configuration";
  }
};

/// The first key at or below `where` that differs and has this effect in the new configuration.
std::optional<Difference> first_difference(const Json& theirs, const Json& ours, const std::string& where,
                                           KeyEffect effect, const Json& config) {
  if (theirs == ours || where == "/seed" || where == "/draw") return std::nullopt;
  const auto is_open = [](const Json& value) { return value.is_object() || value.is_null(); };
  if (!is_open(theirs) || !is_open(ours)) {
    const bool is_malformed = ours.is_object() || theirs.is_object();  // in a foreign file
    const bool counts = is_malformed || effect_of(where, config).value_or(KeyEffect::beam) == effect;
    return counts ? std::optional(Difference{where, theirs, ours}) : std::nullopt;
  }
  Json keys = theirs.is_null() ? Json::object() : theirs;
  if (!ours.is_null()) keys.update(ours);
  for (const auto& item : keys.items()) {
    const std::string& key = item.key();
    const auto inner = [&](const Json& side) { return side.is_null() ? Json() : side.value(key, Json()); };
    if (auto found = first_difference(inner(theirs), inner(ours), where + "/" + key, effect, config))
      return found;
  }
  return std::nullopt;
}

bool has_receiver(const Json& config) {
  const Json type = value_at(config, "/receiver/type");
  return !type.is_null() && type != "none";
}

/// True if the configuration drops no pixel that hit.
bool loses_nothing(const Json& config) {
  return value_at(config, "/noise/dropout_frac") == 0 && value_at(config, "/noise/dead_pixel_frac") == 0 &&
         !has_receiver(config);
}

bool has_false_returns(const Json& config) {
  const Json share = value_at(config, "/noise/false_return_frac");
  return !share.is_null() && share != 0;
}

/// A key by which random numbers move the true beams; empty if no such key is on.
std::string random_numbers_move_beams_by(const Json& config) {
  for (const EffectiveKey& key : keys_in_effect(config))
    if (key.is_drawn && key.effect == KeyEffect::beam) return key.pointer;
  return {};
}

/// The input files that determine the true ranges; a table of estimated poses does where patterns aim from
/// it.
Json inputs_of_truth(const Json& inputs, const Json& config) {
  const bool aims_from_estimate = effect_of("/navigation_error/table", config) == KeyEffect::beam;
  Json kept = Json::array();
  for (const Json& input : inputs) {
    const std::string role = input.value("role", "");
    if ((role != "navigation" || aims_from_estimate) && role != "offsets") kept.push_back(input);
  }
  return kept;
}

/// Why a scan cannot be redrawn, with the option and the scan's name before.
class Refusal {
 public:
  Refusal(const RangeFile& scan, const std::string& option) : scan_(scan), option_(option) {}
  [[noreturn]] void operator()(const std::string& why) const {
    throw UsageError(option_ + scan_.file().name() + ": " + why);
  }

 private:
  const RangeFile& scan_;
  const std::string& option_;
};

void require_same_beams(const Json& theirs, const Json& ours, const Refusal& refuse) {
  if (const auto found = first_difference(theirs, ours, "", KeyEffect::beam, ours)) refuse(found->text());
  const std::string key = random_numbers_move_beams_by(ours);
  for (const char* const where : {"/seed", "/draw"})
    if (const Difference seed{where, value_at(theirs, where), value_at(ours, where)};
        !key.empty() && seed.theirs != seed.ours)
      refuse(seed.text() + "; the true beams follow it by " + key);
}

void require_same_echoes(const RangeFile& scan, const Json& ours, const Refusal& refuse) {
  if (scan.has_several_returns())
    refuse(
        "has several returns per pixel (/receiver/returns is \"all\"); only a scan with one return per pixel "
        "can be redrawn");
  const Json& theirs = scan.file().config();
  if (!has_receiver(ours) && !has_receiver(theirs)) return;
  if (const auto found = first_difference(theirs, ours, "", KeyEffect::echo, ours)) refuse(found->text());
  const Json& receiver = ours["receiver"];
  if (receiver["type"] == "geiger")
    refuse("a Geiger-mode receiver needs the whole waveforms, which no scan keeps; trace the rays");
  const bool lacks_later = receiver.value("returns", "first") == "first" && !scan.keeps_later_echoes();
  if (!scan.keeps_echoes() || lacks_later)
    refuse("does not hold the echoes that its receiver saw; make it with scan-sim --keep-echoes");
}

void require_complete_ranges(const RangeFile& scan, const Refusal& refuse) {
  if (!loses_nothing(scan.file().config()) && !scan.keeps_misses())
    refuse(
        "the ranges of its dropped, dead and undetected pixels are missing; make it with "
        "scan-sim --keep-misses, or with /noise/dropout_frac and /noise/dead_pixel_frac 0 and no receiver");
  if (!scan.has_exact_ranges()) refuse("its ranges are in single precision (scan-sim --float32)");
}

}  // namespace

void require_redraw(const RangeFile& scan, const Provenance& provenance, const std::string& option) {
  const Refusal refuse(scan, option);
  const LandfallFileReader& file = scan.file();
  if (!file.config().is_object() || file.chain().empty()) refuse("does not say how it was made");
  const Json& step = file.chain().back();
  if (step.value("version", "") != program_version())
    refuse("made by version " + step.value("version", "?") + ", this is " + program_version());
  require_same_beams(file.config(), provenance.config, refuse);
  require_same_echoes(scan, provenance.config, refuse);
  const auto of_truth = [&](const Json& inputs) { return inputs_of_truth(inputs, provenance.config); };
  if (of_truth(step.value("inputs", Json())) != of_truth(provenance.as_step().at("inputs")))
    refuse("its terrain or a table (trajectory, pixels, ...) differs from this run's");
  require_complete_ranges(scan, refuse);
}

bool has_rows_of(const RangeFile& scan, const Json& config, bool keep_misses) {
  if (keep_misses != scan.keeps_misses()) return false;
  if (has_false_returns(config) || has_false_returns(scan.file().config())) return false;
  return keep_misses || (loses_nothing(config) && loses_nothing(scan.file().config()));
}

}  // namespace landfall
