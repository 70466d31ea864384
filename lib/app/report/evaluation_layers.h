// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "app/report/page_parts.h"
#include "base/core/fields.h"
#include "base/raster/region.h"
#include "chain/evaluation/evaluate.h"
#include "chain/evaluation/fail_flag.h"

namespace landfall::html_report {

/// The number of a region's values in each of equally wide classes from `low` to `high`, the least and the
/// greatest value. Empty if there is no value.
struct Histogram {
  double low = 0;
  double high = 0;
  std::vector<std::int64_t> count;
  LANDFALL_FIELDS(low, high, count)
};

/// NaN and infinite values are ignored. There is one class if all values are equal. T: double or float. The
/// result does not depend on the number of threads.
template <class T>
[[nodiscard]] Histogram histogram(const Grid<T>& layer, const BinMask& region, std::size_t classes);

/// Error histograms of one axis (x, y or z): of the region's bins, and of its footprints.
struct AxisHistograms {
  Histogram error;
  Histogram relative;
};

/// The number of bins of the region with each FailFlag, from the lowest bit up.
using FailCounts = std::array<std::int64_t, dictionary::kFailFlags.size()>;

/// Reduces an evaluation's layers as it receives them. Keeps the reduced maps to the end and, for every bin
/// of the DEM, 5 bytes (for a while 9): whether the bin is judged, and how close the footprint centred on it
/// is to a limit.
class ReportLayers : public LayerSink {
 public:
  /// Maps of more than `max_cells` bins along an axis are reduced to at most that number.
  ReportLayers(const GridSpec& spec, const EvaluationParameters& parameters,
               std::int64_t max_cells = kMaxCells);

  /// Receives z_est and z_true; call it before the evaluation, which overwrites the truth.
  void take(const DemLayers& dem);
  /// Receives the number of returns per bin.
  void take(const Grid<std::int32_t>& count);

  void take(const CoverageLayers& layers) override;
  void take(Axis axis, const AxisLayers& layers) override;
  void take(const Grid<std::int8_t>& fail) override;

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  [[nodiscard]] std::int64_t factor() const { return factor_; }
  /// The layers in the order in which they were received.
  [[nodiscard]] const std::vector<ReportLayer>& layers() const { return layers_; }
  [[nodiscard]] const AxisHistograms& histograms(Axis axis) const {
    return histograms_[static_cast<std::size_t>(axis)];
  }
  [[nodiscard]] const FailCounts& fail_counts() const { return fail_counts_; }
  /// For every footprint, the largest ratio of its values to their limits; NaN if there is no footprint.
  /// Empty without truth.
  [[nodiscard]] const Grid<float>& shares() const { return shares_; }

 private:
  template <class T>
  void add(ReportLayer layer, const Grid<T>& values);
  void add_shares(Axis axis, const std::string& name, const AxisLayers& layers);

  GridSpec spec_;
  EvaluationLimits limits_;
  std::int64_t factor_;
  std::vector<ReportLayer> layers_;
  std::array<AxisHistograms, 3> histograms_;
  FailCounts fail_counts_{};
  BinMask region_;
  Grid<float> shares_;
  Grid<float> absolute_x_;  ///< kept until the y axis is received
};

}  // namespace landfall::html_report
