// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/number_text.h"
#include "raster/grid_spec.h"

namespace landfall {

/// "2,001 x 1,501 bins": columns, then rows.
[[nodiscard]] inline std::string size_text(const GridSpec& spec) {
  return grouped(spec.cols) + " x " + grouped(spec.rows) + " bins";
}

}  // namespace landfall
