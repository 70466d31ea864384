// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "chain/evaluation/dem_layers.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/evaluation/judge/tile_verdict.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/parameters.h"

namespace landfall {

/// The numbers of Metrics that decide the requirements, under the same keys.
struct DecisiveMetrics {
  struct Accuracy {
    static constexpr bool kShownEmpty = true;
    struct Horizontal {
      std::optional<double> within_limit_frac;
      LANDFALL_FIELDS(within_limit_frac)
    };
    struct Absolute {
      Horizontal horizontal;
      LANDFALL_FIELDS(horizontal)
    };
    struct Axis {
      std::optional<std::int64_t> violation_count;  ///< none where relative errors are not judged
      LANDFALL_FIELDS(violation_count)
    };
    struct Relative {
      Axis x, y, z;
      LANDFALL_FIELDS(x, y, z)
    };
    Absolute absolute;
    Relative relative;
    LANDFALL_FIELDS(absolute, relative)
  };

  std::optional<bool> pass;
  CoverageMetrics coverage;
  std::optional<Accuracy> accuracy;  ///< null without truth
  Table1Verdicts requirements;
  RequirementVerdicts own_requirements;
  LANDFALL_FIELDS(pass, coverage, accuracy, requirements, own_requirements)
};

/// The fields on which a user can set requirements, of those of metrics_fields().
[[nodiscard]] std::vector<ResultField> decisive_fields();

struct Verdict {
  DecisiveMetrics metrics;
  Grid<std::int8_t> fail;  ///< FailFlag bits; 0 outside the region
};

/// The metrics that follow from the footprints beyond their limits, none without truth, and from the bins
/// that have an elevation. Sets the flags of judge_coverage() in `fail`.
[[nodiscard]] DecisiveMetrics decisive_metrics(const std::optional<TileVerdict>& footprints,
                                               const BinMask& valid, const BinMask& region,
                                               const EvaluationParameters& parameters,
                                               Grid<std::int8_t>& fail);

/// Judges a DEM as evaluate() does, to the last bit, but computes only what decides the requirements and the
/// layer `fail`: no quantile of a footprint whose verdict follows from counts. Several times faster, and the
/// layers are only read, so that a caller keeps their memory for the next DEM.
///
/// `region` is judged_region(), for any number of DEMs of one grid. The result does not depend on the number
/// of threads. `corrected` and `region_mask` of a DEM are not used.
///
/// Throws UsageError for parameters that check() refuses; FormatError when layers differ in grid or hold an
/// infinite value.
[[nodiscard]] Verdict decide(const DemLayers& dem, const BinMask& region,
                             const EvaluationParameters& parameters);

}  // namespace landfall
