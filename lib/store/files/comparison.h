// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "store/files/contents.h"
#include "store/files/meeting.h"

namespace landfall {

/// Compares two files of one kind as one JSON object (docs/user/landfall-info.md lists its keys): the
/// configuration keys that differ, of the files and of their upstream steps; requirements and numbers of
/// metrics, scores and verdicts side by side; the places of both; for grids whose bins coincide once B is
/// placed in the frame of A (meeting.h) the bins in common and the statistics of B - A of each layer, else
/// the reason why there are none; for draws with equal seeds the pairs of each requirement and of landings;
/// for scans how like they are (scan_likeness.h). Differences are B - A. Unknown numbers are null. `answer`:
/// answer_of(). Throws FormatError as LandfallFileReader, UsageError for files of two kinds.
struct ComparisonRequest {
  MeetingRules rules = {};
  bool statistics = true;  ///< false: layers are not read
  /// Receives each layer on the bins in common, B placed in the frame of A.
  std::function<void(const std::string& kind, const ContentInfo& layer, const Grid<double>& a,
                     const Grid<double>& b)>
      on_layer = {};
};
[[nodiscard]] nlohmann::ordered_json compare_files(const std::filesystem::path& a,
                                                   const std::filesystem::path& b,
                                                   const ComparisonRequest& request = {},
                                                   const ProgressCallback& progress = {});

}  // namespace landfall
