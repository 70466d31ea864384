// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/core/parallel.h"
#include "base/raster/grid_spec.h"

namespace landfall {

/// Calls work(row) for each row of [0, rows), in any order and on any thread.
template <class Work>
void by_rows(std::int64_t rows, const Work& work, const ProgressCallback& progress = {}) {
  constexpr std::size_t kRows = 16;
  const auto piece = [&](std::size_t begin, std::size_t end) {
    for (std::size_t row = begin; row < end; ++row) work(static_cast<std::int64_t>(row));
  };
  parallel_for(static_cast<std::size_t>(rows), kRows, piece, progress);
}

/// Calls work(row) for each row of a map.
template <class Work>
void by_rows(const GridSpec& spec, const Work& work, const ProgressCallback& progress = {}) {
  by_rows(spec.rows, work, progress);
}

}  // namespace landfall
