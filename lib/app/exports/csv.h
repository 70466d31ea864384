// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "app/exports/grid_layers.h"
#include "app/exports/point_reader.h"
#include "base/core/progress.h"
#include "base/output/byte_sink.h"

namespace landfall {

/// Writes points as comma-separated text: one header line, then one line per selected row. `pass` defines the
/// columns and their order.
void write_points_csv(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress = {});

/// Writes layers of one grid (at least one) as comma-separated text: the header x_m, y_m and the layers'
/// names, then a line per bin, row by row from the south, including bins without a value. Of these lines, the
/// first and every N-th after it are written.
void write_layers_csv(const std::vector<NamedLayer>& layers, std::size_t every, ByteSink& sink,
                      const ProgressCallback& progress = {});

}  // namespace landfall
