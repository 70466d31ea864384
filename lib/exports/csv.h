// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "base/progress.h"
#include "exports/byte_sink.h"
#include "exports/grid_layers.h"
#include "exports/point_reader.h"
#include "files/contents.h"

namespace landfall {

/// Appends the shortest text that reads back as the same value of its type; `nan` for any NaN.
template <class T>
void append_number(std::string& out, T value) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) {  // the sign of a NaN is of no interest
      out += "nan";
      return;
    }
  }
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out.append(text.data(), static_cast<std::size_t>(end - text.data()));
}

/// Writes points as comma-separated text: one line of headings, one line per selected row. `pass` says
/// which columns, in which order.
void write_points_csv(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

/// Writes layers of one grid (at least one) as comma-separated text: headings x_m, y_m and the layers', then
/// a line per bin, row by row from the south, bins without a value included; of these lines the first and
/// every N-th after it.
void write_layers_csv(const std::vector<NamedLayer>& layers, std::size_t every, ByteSink& sink,
                      const ProgressCallback& progress = {});

}  // namespace landfall
