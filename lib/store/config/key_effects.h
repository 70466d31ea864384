// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace landfall {

// The effects of the keys of a scan's configuration, as schemas/scan.schema.json states for each key:
// "effect", which the keys below inherit, "drawn" and "sigma"; "beam_with", for a whole section, the value of
// another key with which its keys move the beams.

/// The part of a scan that a key changes.
enum class KeyEffect {
  beam,      ///< the true beams or what they hit: another value needs another trace
  echo,      ///< the echoes that a receiver sees, or which of them it reports
  estimate,  ///< only measurements and estimates: a redraw takes another value
};

/// The sigma of `regrid --uncertainty` that covers an error.
enum class CoveringSigma {
  none,        ///< the key makes no error
  range,       ///< known from the scan
  given,       ///< of the ranges, and must be given
  navigation,  ///< of the navigation, and must be given
  never,       ///< not random, or not normal
};

struct EffectiveKey {
  std::string pointer;  ///< "/scanner/encoder_sigma_rad"
  KeyEffect effect;
  bool is_drawn;  ///< the seed draws an error of this size
  CoveringSigma sigma;
};

/// The effect of a key in a configuration: `beam` for a navigation error of a scan whose pattern aims from
/// the estimate ("beam_with" in the schema), else effect_of(pointer).
[[nodiscard]] std::optional<KeyEffect> effect_of(const std::string& pointer, const nlohmann::json& config);

/// The effect of a key, "/laser/scan_time_s" or, of an element, "/detector/ifov_rad/0". Of a key that
/// several scanners have the first of KeyEffect's list; of an unknown one that of the nearest known key above
/// it, none at the top. None of "/seed": the drawn keys say what it moves.
[[nodiscard]] std::optional<KeyEffect> effect_of(const std::string& pointer);

/// The keys whose effect, drawing or sigma the schema states and that are on in this configuration: they have
/// a value other than the schema's default. Where values choose by "type", those of the type. In the
/// alphabetical order of the schema's keys. The configuration may be a foreign file's, of any structure.
[[nodiscard]] std::vector<EffectiveKey> keys_in_effect(const nlohmann::json& config);

}  // namespace landfall
