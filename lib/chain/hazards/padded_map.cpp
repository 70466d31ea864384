// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/padded_map.h"

#include <algorithm>

#include "base/raster/by_rows.h"

namespace landfall {

PaddedMap::PaddedMap(const Grid<double>& map, std::int64_t margin) : PaddedMap(map.spec(), margin) {
  by_rows(rows_, [&](std::int64_t row) { std::ranges::copy(map.row(row), at(row, 0)); });
}

}  // namespace landfall
