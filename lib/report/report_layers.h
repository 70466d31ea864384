// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "evaluation/evaluate.h"
#include "report/histogram.h"
#include "report/quantised.h"
#include "report/reduction.h"

namespace landfall::html_report {

/// How a map is drawn.
enum class Style { elevation, signed_error, magnitude, count, mask, flags };

/// A layer as the report holds it.
struct ReportLayer {
  std::string name;  ///< the dataset's
  std::string title;
  std::string unit;  ///< empty for a number
  Style style = Style::elevation;
  Rule rule = Rule::mean;
  Quantised values;
};

/// One axis of the errors, by x, y, z: of the region's bins, and of its footprints.
struct AxisHistograms {
  Histogram error;
  Histogram relative;
};

/// Makes an evaluation's layers small as they pass by. Kept until the end are the small maps and, of every
/// bin of the DEM, 5 bytes, for a while 9: whether it is judged, and how close the footprint about it is to a
/// limit.
class ReportLayers : public LayerSink {
 public:
  /// Maps of more than `most_cells` bins along an axis are reduced to at most as many.
  ReportLayers(const GridSpec& spec, const EvaluationParameters& parameters, std::int64_t most_cells = 1024);

  /// z_est, z_true: before they are judged, which uses up the truth.
  void take(const DemLayers& dem);
  /// Returns per bin.
  void take(const Grid<std::int32_t>& count);

  void take(const CoverageLayers& layers) override;
  void take(Axis axis, const AxisLayers& layers) override;
  void take(const Grid<std::int8_t>& fail) override;

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  [[nodiscard]] std::int64_t factor() const { return factor_; }
  /// In the order in which they came.
  [[nodiscard]] const std::vector<ReportLayer>& layers() const { return layers_; }
  [[nodiscard]] const AxisHistograms& histograms(Axis axis) const {
    return histograms_[static_cast<std::size_t>(axis)];
  }
  /// Bins of the region with each FailFlag, from the lowest bit up.
  [[nodiscard]] const std::array<std::int64_t, 6>& fail_counts() const { return fail_counts_; }
  /// Of every footprint the largest of its values over its limit; NaN where there is none. Empty without
  /// truth.
  [[nodiscard]] const Grid<float>& shares() const { return shares_; }

 private:
  template <class T>
  void add(ReportLayer layer, const Grid<T>& values);
  void add_shares(Axis axis, const AxisLayers& layers);

  GridSpec spec_;
  EvaluationLimits limits_;
  std::int64_t factor_;
  std::vector<ReportLayer> layers_;
  std::array<AxisHistograms, 3> histograms_;
  std::array<std::int64_t, 6> fail_counts_{};
  BinMask region_;
  Grid<float> shares_;
  Grid<float> absolute_x_;  ///< until that of y has come
};

}  // namespace landfall::html_report
