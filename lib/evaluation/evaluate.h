// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/progress.h"
#include "evaluation/dem_layers.h"
#include "evaluation/holes.h"
#include "evaluation/metrics.h"
#include "evaluation/parameters.h"

namespace landfall {

/// Bits of the layer `fail`: why a bin, or the footprint centred on it, misses a requirement.
enum FailFlag : std::int8_t {
  kFailRelativeX = 1,
  kFailRelativeY = 2,
  kFailRelativeZ = 4,
  kFailAbsoluteHorizontal = 8,
  kFailHoleSize = 16,  ///< every bin of a hole over the limit
  kFailDistance = 32,
};

/// One axis: x, y or z.
struct AxisLayers {
  Grid<double> error;    ///< e (Eq. 10), every bin of the DEM
  Grid<float> absolute;  ///< mean of e over the footprint (Eq. 11); NaN outside the region
  Grid<float> relative;  ///< quantile of |e - mean| (Eq. 12); NaN outside the region
};

struct AccuracyLayers {
  AxisLayers x, y, z;
};

struct EvaluationLayers {
  BinMask in_region;
  BinMask invalid;                ///< z_est NaN inside the region; 0 outside it
  Grid<std::int32_t> hole_id;     ///< 0 for none
  Grid<float> distance_to_valid;  ///< bins, every bin of the DEM; 0 on valid bins; infinite if there is none
  Grid<std::int8_t> fail;         ///< FailFlag bits; 0 outside the region
  std::optional<AccuracyLayers> accuracy;  ///< empty without truth
};

struct Evaluation {
  Metrics metrics;
  std::vector<Hole> holes;
  std::optional<EvaluationLayers> layers;  ///< empty for EvaluationOutput::metrics_only
};

enum class EvaluationOutput { layers_and_metrics, metrics_only };

/// Judges a DEM against Table 1 (Chen et al., Eqs. 10-12). The result does not depend on the number of
/// threads, the metrics not on the output mode. Without truth it judges coverage only.
///
/// A footprint is centred on a bin of the region, clipped at the DEM's border; bins outside the region count,
/// NaN does not. All limits are compared in double, before layers are rounded to float.
///
/// Throws UsageError for parameters that check() refuses or a region that does not fit the DEM; FormatError
/// when layers differ in grid or hold an infinite value.
///
/// Memory beside the DEM's own 32 bytes per bin, measured at 2001 x 2001 on two threads: 91 bytes per bin
/// with layers, 49 without (peaks of dem-eval of 470 and 309 MiB, the DEM included).
[[nodiscard]] Evaluation evaluate(const DemLayers& dem, const EvaluationParameters& parameters,
                                  EvaluationOutput output = EvaluationOutput::layers_and_metrics,
                                  const ProgressCallback& progress = {});

}  // namespace landfall
