// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/padded_map.h"

#include <algorithm>

#include "base/parallel.h"

namespace landfall {

PaddedMap::PaddedMap(const Grid<double>& map, std::int64_t margin) : PaddedMap(map.spec(), margin) {
  constexpr std::size_t kCopiedRows = 64;
  parallel_for(static_cast<std::size_t>(rows_), kCopiedRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row)
      std::ranges::copy(map.row(static_cast<std::int64_t>(row)), at(static_cast<std::int64_t>(row), 0));
  });
}

}  // namespace landfall
