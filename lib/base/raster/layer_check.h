// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "base/raster/grid.h"

namespace landfall {

/// The values that a layer may have, besides NaN, which means none.
enum class LayerValues {
  finite,
  not_negative  ///< finite, and at least 0: a 1-sigma or a count
};

/// Throws FormatError "NAME: the value in row R, column C is infinite", or is negative, for the first value,
/// in row-major order, that the layer may not have. `first_row` is the row R of the first one, if these are
/// whole rows of a larger layer. T: double, float or std::int32_t.
template <class T>
void require_values(const Grid<T>& layer, const std::string& name, LayerValues allowed,
                    std::int64_t first_row = 0);

}  // namespace landfall
