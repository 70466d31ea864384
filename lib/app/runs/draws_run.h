// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/runs/draw_series.h"
#include "app/runs/draws_parts.h"
#include "base/core/progress.h"
#include "base/output/output_path.h"

namespace landfall {

/// A traced scan and the terrain that it scanned.
struct ScanPair {
  std::string scan;     ///< scan.h5; empty: each draw traces its rays
  std::string terrain;  ///< terrain.h5; may be empty for draws that trace
};

/// The scans and terrains of a run of draws.
struct DrawsSources {
  /// With several, all draws run over the first, then over the next: row p N + i is draw i of N over pair p.
  /// Such a run has no maps.
  std::vector<ScanPair> pairs;
  std::string samples;  ///< a table of values; empty: none
  /// The OpenCL device that draws errors and grids the returns; none: the CPU does.
  std::optional<OpenClOptions> device{};
  TerrainMaker make_terrain{};  ///< for draws that trace
  MeetingRules rules{};
};

struct DrawsOutput {
  OutputOptions file;
  nlohmann::json config;    ///< of the run of draws
  Provenance provenance;    ///< its configuration and inputs are added later
  std::string config_name;  ///< for messages
  PhaseRunner phase;
  std::function<void(const std::string&)> warn;
  std::function<void(const std::string&)> log;
  std::function<void(const std::string&)> note;  ///< gets the verdict so far, after each draw
  std::function<double()> clock_s;
  /// Called with the finished draws before the output is complete; may be empty.
  std::function<void(const Draws&, const nlohmann::ordered_json& verdict, const Provenance&)> report{};
};

struct DrawsSummary {
  nlohmann::ordered_json verdict;  ///< verdict_json()
  double draws_per_s = 0;          ///< of this run
};

/// Makes the draws, or a part of them, and writes draws.h5. At most every 30 s the state of the run is
/// written next to the output (DrawsState); a run with the same inputs begins there. An interrupt ends the
/// run after the draw that is being made and a last state. The state is removed when the output is complete.
/// Throws as DrawsConfig and DrawSeries do, and UsageError for a part beyond the rows or of a sequential
/// test, and for a sequential test over several pairs.
DrawsSummary run_draws(const DrawsSources& sources, const std::optional<DrawSpan>& part, DrawsOutput output);

}  // namespace landfall
