// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "bins.h"
#include "chain/evaluation/evaluate.h"

namespace landfall::testing_layers {

/// Collects the layers of an evaluation.
struct Layers : LayerSink {
  void take(const CoverageLayers& layers) override { coverage = layers; }
  void take(Axis axis, const AxisLayers& layers) override {
    (axis == Axis::x ? x : axis == Axis::y ? y : z) = layers;
  }
  void take(const Grid<std::int8_t>& flags) override { fail = flags; }

  CoverageLayers coverage;
  std::optional<AxisLayers> x, y, z;
  Grid<std::int8_t> fail;
};

struct Collected {
  Metrics metrics;
  std::vector<Hole> holes;
  Layers layers;
};

/// An evaluation and its layers.
inline Collected collected(DemLayers dem, const EvaluationParameters& parameters) {
  Collected result;
  Evaluation evaluation = evaluate(std::move(dem), parameters, {&result.layers});
  result.metrics = std::move(evaluation.metrics);
  result.holes = std::move(evaluation.holes);
  return result;
}

/// A perfect flat DEM.
inline DemLayers perfect_dem(const GridSpec& spec) {
  return {Grid<double>(spec, 7),
          TrueLayers{grid_of(spec, [](double x, double) { return x; }),
                     grid_of(spec, [](double, double y) { return y; }), Grid<double>(spec, 7)}};
}

/// The same of 1 m bins, 2 half + 1 on a side.
inline DemLayers perfect_dem(std::int64_t half) {
  return perfect_dem(GridSpec::centered(static_cast<double>(half), 1));
}

}  // namespace landfall::testing_layers
