// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/raster/region.h"
#include "chain/draws/draw_maps.h"
#include "chain/draws/draw_runner.h"
#include "chain/draws/draw_table.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// The draws of a run, or of a part of one.
struct Draws {
  DrawTable table;
  /// Footprint::edge_bins() of all draws; none where the footprint varies, and in files of version 0.2.0.
  std::optional<std::int64_t> footprint_bins;
  std::optional<DrawMaps> maps;
  // With maps:
  std::optional<BinMask> region;         ///< the judged bins
  std::optional<Grid<float>> map_truth;  ///< H(X, Y), NaN off the terrain; none where the terrain varies
  std::optional<Grid<float>> predicted_sigma;  ///< if it is requested
};

/// A number of a draw by its dotted path in metrics.json.
using NamedNumber = std::pair<std::string, double>;

/// The numbers of metrics.json without arrays and texts: null as NaN, true as 1. `pass` and
/// `version` are not among them. After them those of score.json as score.KEY and of its best site as
/// site.KEY, NaN where there is no site, and landing.KEY and blind.KEY of a draw that lands.
[[nodiscard]] std::vector<NamedNumber> flat_metrics(const DrawResult& result);

/// Writes draws.h5 (docs/user/files/draws.md) and commits it. `verdict` (store/files/draws_verdict.h) is
/// stored as text.
void write_draws(LandfallFileWriter& file, const Draws& draws, const nlohmann::ordered_json& verdict,
                 const std::string& crs_wkt);

/// A file of draws, complete or a part.
struct DrawsInput {
  Draws draws;
  std::string crs_wkt;
  std::string file_id;
  nlohmann::json chain;  ///< its last step made the file
  /// The file is of version 0.2.0: draw i has the seed of the run plus i, and so random numbers that
  /// runs of draws with other seeds have too.
  bool counts_seeds = false;
};

/// Throws FormatError.
[[nodiscard]] DrawsInput read_draws(const std::filesystem::path& path);

}  // namespace landfall
