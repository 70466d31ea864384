// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/progress.h"
#include "exports/grid_layers.h"
#include "exports/point_reader.h"
#include "files/contents.h"
#include "output/byte_sink.h"

namespace landfall {

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
