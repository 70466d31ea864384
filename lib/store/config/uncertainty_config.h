// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chain/gridding/uncertainty.h"

namespace landfall {

/// A scan that is gridded into a DEM, and the configuration that made it (null if unknown).
struct ScanOrigin {
  std::string name;
  nlohmann::json config;
};

/// The keys of /uncertainty/navigation_sigma, which are those of a scan's /navigation_error.
[[nodiscard]] const std::array<const char*, 4>& navigation_sigma_keys();

/// Adds "KEY=SIGMA" (all three axes) or "KEY=X,Y,Z" to /uncertainty/navigation_sigma of a regrid
/// configuration; KEY is position_m, velocity_mps, rpy_rad or rpy_rate_radps. Missing keys become 0. Throws
/// UsageError.
void add_navigation_sigma(nlohmann::json& config, const std::string& assignment);

/// How messages name the uncertainty of a DEM and its sigmas: by the options of regrid, or, where its
/// configuration `name` is a section of another ("chain.json: /regrid"), by keys.
struct UncertaintyWords {
  std::string subject;  ///< the beginning of a message
  std::string range_sigma;
  std::string navigation_sigma;
};
[[nodiscard]] UncertaintyWords uncertainty_words(const std::string& name);

/// The sigmas of regrid.json's /uncertainty; missing ones are taken from the scans. range_sigma_m is that of
/// the scans if they agree, with the timer's jitter and steps, and navigation_sigma is 0 if they were made
/// without navigation and pointing errors. Throws UsageError, saying which option or key to give, if a sigma
/// cannot be determined: a navigation error in a scan is one draw, not its sigma.
[[nodiscard]] UncertaintyParameters uncertainty_parameters(const nlohmann::json& config,
                                                           const std::string& name,
                                                           const std::vector<ScanOrigin>& scans);

/// The errors that are switched on in the scans and that these sigmas leave out, each once, by their place in
/// the scan's configuration: systematic ones (the bias of ranges, tof_lag, errors of the mirror's clock,
/// encoder harmonics, unknown facet tilts, the estimator "first" with sub-pixels, a receiver, pixel offsets,
/// the clock's scale), false returns, and navigation and pointing errors whose sigma is 0.
[[nodiscard]] std::vector<std::string> errors_left_out(const UncertaintyParameters& parameters,
                                                       const std::vector<ScanOrigin>& scans);

/// The parameters as /uncertainty of a configuration.
[[nodiscard]] nlohmann::json uncertainty_json(const UncertaintyParameters& parameters);

}  // namespace landfall
