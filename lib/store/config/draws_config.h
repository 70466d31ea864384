// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/text/number_table.h"
#include "chain/draws/draw_runner.h"
#include "chain/draws/sprt.h"
#include "chain/draws/variation.h"
#include "chain/gridding/uncertainty.h"
#include "store/config/json_source.h"

namespace landfall {

/// The configurations of the stages of one draw: resolved, with the draw's number and values.
struct DrawStages {
  nlohmann::json scan;
  nlohmann::json regrid;
  nlohmann::json eval;
  nlohmann::json hazard;   ///< null: no hazards
  nlohmann::json terrain;  ///< null: the ground is a file's
};

/// A run of draws (docs/user/monte-carlo.md).
class DrawsConfig {
 public:
  /// `resolved` is the configuration of monte-carlo, `scanned` the resolved configuration of the traced scan,
  /// null for draws that trace; `samples` may be null. Throws UsageError that begins with `name`: for a
  /// configuration of a stage that its schema refuses, a varied key that does not exist, is no number, or
  /// changes the grid or a judged region (over a traced scan, the rays, too), a key that both `vary` and the
  /// samples have, a section for draws that trace over a traced scan; FormatError for samples without a row
  /// or with a value that is not finite.
  DrawsConfig(const nlohmann::json& resolved, std::string name, const nlohmann::json& scanned,
              const NumberTable* samples);

  /// Begins messages.
  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::int64_t draw_count() const { return draw_count_; }
  [[nodiscard]] MetricsKind metrics() const { return metrics_; }
  [[nodiscard]] bool has_layers() const { return has_layers_; }
  /// The parameters of the predicted 1-sigma map: /regrid/uncertainty; what it lacks is taken from the varied
  /// navigation errors, and the range noise from the scan (D318). Empty if the map is not requested.
  [[nodiscard]] const std::optional<UncertaintyParameters>& predicted() const { return predicted_; }
  /// Whether hazards are judged on the DEM of each draw.
  [[nodiscard]] bool has_hazards() const { return !stages_.hazard.is_null(); }
  /// Whether each draw traces its rays; else they are those of the scan.
  [[nodiscard]] bool traces() const { return traces_; }
  /// Whether draws have different terrains.
  [[nodiscard]] bool terrain_varies() const { return terrain_varies_; }
  /// Whether each DEM has its 1-sigma map.
  [[nodiscard]] bool has_uncertainty() const { return has_uncertainty_; }
  /// How the draws land; empty where they do not.
  [[nodiscard]] const std::optional<LandingParameters>& landing() const { return landing_; }
  /// Footprint::edge_bins() of the draws; none where the footprint varies.
  [[nodiscard]] std::optional<std::int64_t> footprint_bins() const;
  /// Says, with the draw where draws differ, why relative errors are not judged; nothing where all draws
  /// judge them.
  [[nodiscard]] std::optional<std::string> why_not_judged() const;
  /// Empty for the rule `fixed`.
  [[nodiscard]] const std::optional<SprtParameters>& sprt() const { return sprt_; }
  /// Whether the sequential test is one of the landings.
  [[nodiscard]] bool tests_landing() const { return tests_landing_; }
  /// The varied keys in the order of their names.
  [[nodiscard]] std::vector<std::string> varied_keys() const;
  /// The stages before a draw changes them.
  [[nodiscard]] const DrawStages& stages() const { return stages_; }
  /// Keys of the configuration that have no effect, a message each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }
  /// With all defaults, for the provenance; samples are not part of it.
  [[nodiscard]] nlohmann::json json() const { return json_; }

  /// The values of the varied keys in a draw.
  [[nodiscard]] std::vector<double> values(std::int64_t draw) const;
  [[nodiscard]] RandomSeed seed(std::int64_t draw) const { return {seed_, static_cast<std::uint32_t>(draw)}; }
  /// Draws of [first, end), in order, whose stages() decide whether those of all are accepted: a schema
  /// bounds each value alone, from above and below, and may ask for whole numbers. At most three for each
  /// key, and the first and the last one, of which at least one has other random numbers than the scan.
  [[nodiscard]] std::vector<std::int64_t> deciding_draws(std::int64_t first, std::int64_t end) const;
  /// Throws UsageError, naming draw and key, for a value that the stage's schema refuses.
  [[nodiscard]] DrawStages stages(std::int64_t draw) const;

 private:
  [[nodiscard]] bool footprint_varies() const { return vary_.contains("eval.footprint_m"); }
  /// `owner` begins messages about the key.
  void add_variation(const std::string& owner, const std::string& key, Variation<double> variation);
  void take_samples(const NumberTable& samples);
  /// Refuses keys that only draws that trace have.
  void require_scanned(const nlohmann::json& resolved) const;
  void check_requirements() const;
  void warn_of_draw(const nlohmann::json& section, const char* stage);
  void predict();

  std::string name_;
  nlohmann::json json_;
  std::int64_t draw_count_;
  MetricsKind metrics_;
  bool has_layers_;
  std::optional<SprtParameters> sprt_;
  bool tests_landing_ = false;
  std::optional<LandingParameters> landing_;
  std::optional<UncertaintyParameters> predicted_;
  bool traces_;
  bool has_uncertainty_;
  bool has_terrain_seeds_;
  bool terrain_varies_ = false;
  std::uint64_t seed_ = 0;
  std::vector<std::string> warnings_;
  DrawStages stages_;
  nlohmann::json scan_;  ///< without the defaults that other keys of the scan decide
  std::map<std::string, Variation<double>> vary_;
};

/// Checks what can be checked without the scan: as DrawsConfig, but sections of the scan that a run of draws
/// cannot change are only checked for their names. Without a scan, of draws that trace: as DrawsConfig.
void check_draws_config(const nlohmann::json& resolved, const std::string& name, bool has_scan,
                        const NumberTable* samples);

}  // namespace landfall
