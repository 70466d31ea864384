// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "files/scan_file.h"
#include "gridding/method.h"
#include "gridding/uncertainty.h"

namespace landfall {

struct GriddingRequest {
  GridSpec grid;
  Method method = Method::bilinear_nearest;
  bool moments = false;  ///< also what an uncertainty map needs; only with the method bilinear_nearest
};

/// The returns of scans, accumulated in the bins of a DEM.
struct GriddedScans {
  std::unique_ptr<Accumulator> bins;
  const WeightedMeanAccumulator* nearest = nullptr;  ///< the same bins, if the method is bilinear_nearest
  std::optional<MomentAccumulator> moments;
};

/// Grids the scans one after the other, batch by batch, while the next batch is read; the memory needed does
/// not depend on their size. Throws as ScanReader::read() and Accumulator::add() do.
[[nodiscard]] GriddedScans grid_scans(const std::vector<std::unique_ptr<ScanReader>>& scans,
                                      const GriddingRequest& request, const ProgressCallback& progress = {});

}  // namespace landfall
