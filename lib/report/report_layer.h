// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "report/quantised.h"
#include "report/reduction.h"

namespace landfall::html_report {

/// The style in which a map is drawn.
enum class Style {
  elevation,
  signed_error,
  magnitude,
  probability,  ///< from 0 to 1
  chance,       ///< a probability over shaded relief, which is seen where it is 0
  count,
  mask,
  flags,    ///< bits with a colour each, as marks
  classes,  ///< bits with a colour each, of which every bin of the region has one
};

/// A bit of a layer of classes.
struct LayerClass {
  std::int64_t bit = 1;
  std::string text;
  std::uint32_t color = 0;  ///< 0xRRGGBB
  std::int64_t count = 0;   ///< bins that have it
  bool is_mark = false;     ///< single bins are enlarged where few have it
};

/// A layer as stored in the report.
struct ReportLayer {
  std::string name;  ///< the name of the dataset
  std::string title;
  std::string unit;  ///< empty for a dimensionless number
  Style style = Style::elevation;
  Rule rule = Rule::mean;
  Quantised values = {};
  std::optional<double> limit = std::nullopt;  ///< in `unit`; marked on the scale
  std::string quantity = {};                   ///< what the colours show; if empty, the page's scripts know
  int steps = 0;                               ///< most steps of the values; 0: as many as the style needs
  std::vector<LayerClass> classes = {};        ///< a cell has the colour of the first of which it has the bit
};

/// The layer with the values of `grid`, reduced by its rule to blocks of factor x factor bins, in the number
/// of steps that its style needs. T: double, float, std::int32_t or std::int8_t.
template <class T>
[[nodiscard]] ReportLayer reduced_layer(ReportLayer layer, const Grid<T>& grid, std::int64_t factor);

/// The description of a layer for the page's scripts; its values are packed() as `id`.
[[nodiscard]] nlohmann::ordered_json layer_json(const ReportLayer& layer, const std::string& id);

}  // namespace landfall::html_report
