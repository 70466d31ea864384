// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/layers.h"

#include <limits>

namespace landfall {

double true_elevation(const BinValues& values, const GridSpec& spec, BinIndex bin,
                      const ElevationFunction& elevation, TruthAt truth_at) {
  if (values.count == 0) return std::numeric_limits<double>::quiet_NaN();
  if (truth_at == TruthAt::centroid) return elevation(values.x_true, values.y_true);
  return elevation(spec.x(bin.col) + values.x_offset, spec.y(bin.row) + values.y_offset);
}

}  // namespace landfall
