// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <utility>
#include <vector>

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

}  // namespace landfall::testing_layers
