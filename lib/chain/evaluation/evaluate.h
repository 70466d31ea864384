// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/holes.h"
#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/evaluation/metrics.h"
#include "chain/evaluation/parameters.h"

namespace landfall {

struct CoverageLayers {
  BinMask in_region;
  BinMask invalid;                  ///< z_est NaN inside the region; 0 outside it
  Grid<std::int32_t> hole_numbers;  ///< 0 outside holes
  Grid<float> distance_to_valid;    ///< bins, in every bin of the DEM; 0 on valid bins; infinite without any
};

/// One axis: x, y or z.
struct AxisLayers {
  Grid<double> error;    ///< e (Eq. 10), every bin of the DEM
  Grid<float> absolute;  ///< mean of e over the footprint (Eq. 11); NaN outside the region
  Grid<float> relative;  ///< quantile of |e - mean| (Eq. 12); NaN outside the region
};

/// Receives the layers of an evaluation, each as soon as it is final and only for the duration of the call:
/// keeping all of them would double the memory of the evaluation.
class LayerSink {
 public:
  virtual ~LayerSink() = default;
  /// Called first.
  virtual void take(const CoverageLayers& layers) = 0;
  /// Called once for each axis; never without truth.
  virtual void take(Axis axis, const AxisLayers& layers) = 0;
  /// Called last, with Evaluation::fail.
  virtual void take(const Grid<std::int8_t>& fail) = 0;
};

struct Evaluation {
  Metrics metrics;
  std::vector<Hole> holes;
  BinMask region;          ///< the bins that were judged
  Grid<std::int8_t> fail;  ///< FailFlag bits; 0 outside the region
};

/// Judges a DEM against Table 1 (Chen et al., Eqs. 10-12) and passes the layers to each sink. The result
/// depends neither on the number of threads nor on the sinks. Without truth it judges coverage only. A DEM
/// that is moved in is freed layer by layer.
///
/// A footprint is centred on a bin of the region and clipped at the DEM's border; bins outside the region
/// count, NaN does not. All limits are compared in double, before layers are rounded to float.
///
/// Throws UsageError for parameters that check() refuses or a region that does not fit the DEM; FormatError
/// when the mask is unusable, layers differ in grid or hold an infinite value.
[[nodiscard]] Evaluation evaluate(DemLayers dem, const EvaluationParameters& parameters,
                                  const std::vector<LayerSink*>& sinks = {},
                                  const ProgressCallback& progress = {});

}  // namespace landfall
