// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/report/quantised.h"
#include "base/raster/grid.h"

namespace landfall::html_report {

/// The rule by which a square block of bins is reduced to one value. NaN and infinite values are ignored; a
/// block without any other value becomes NaN.
enum class Rule {
  mean,
  extreme,  ///< the value of the largest magnitude with its sign; the positive one of two equal magnitudes
  largest,
  smallest,
  any_bit,  ///< for integers: the bits that are set in any bin
};

/// A reduced map: block (r, c) covers the bins from (r factor, c factor) on; blocks at the upper and right
/// border may be smaller.
struct ReducedMap {
  std::int64_t factor = 1;
  std::int64_t rows = 0;
  std::int64_t cols = 0;
  std::vector<double> cells;  ///< row-major, y ascending
};

/// The least block size, in bins a side, that gives at most `max_cells` (>= 1) blocks along either axis.
[[nodiscard]] std::int64_t reduction_factor(const GridSpec& spec, std::int64_t max_cells);

/// T: double, float, std::int32_t or std::int8_t. The result does not depend on the number of threads.
template <class T>
[[nodiscard]] ReducedMap reduce(const Grid<T>& layer, std::int64_t factor, Rule rule);

/// The style in which a map is drawn.
enum class Style {
  elevation,
  signed_error,
  magnitude,
  probability,         ///< from 0 to 1
  shaded_probability,  ///< a probability over shaded relief, which is seen where it is 0
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
  std::string quantity = {};             ///< the quantity of the colours; if empty, the page's scripts know
  int steps = 0;                         ///< most steps of the values; 0: as many as the style needs
  std::vector<LayerClass> classes = {};  ///< a cell has the colour of the first of which it has the bit
  std::string group = {};                ///< the heading under which the page shows it
};

/// "#rrggbb".
[[nodiscard]] std::string css_color(std::uint32_t rrggbb);

/// A layer without values: title, unit, style, rule, quantity and group of schemas/dictionary/layers.json.
[[nodiscard]] ReportLayer described(const char* file, const std::string& name);

/// The layer with the values of `grid`, reduced by its rule to blocks of factor x factor bins, in the number
/// of steps that its style needs. T: double, float, std::int32_t or std::int8_t.
template <class T>
[[nodiscard]] ReportLayer reduced_layer(ReportLayer layer, const Grid<T>& grid, std::int64_t factor);

/// The description of a layer for the page's scripts; its values are packed() apart, as `id`.
[[nodiscard]] nlohmann::ordered_json layer_json(const ReportLayer& layer, const std::string& id);

}  // namespace landfall::html_report
