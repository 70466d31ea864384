// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>

#include "base/numerics/random.h"
#include "base/raster/region.h"

namespace landfall::testing_masks {

/// A mask drawn as text, north on top: '#' is 1, anything else 0. Bin (0, 0) is the origin, 1 m bins.
inline BinMask drawn(std::initializer_list<std::string_view> rows_from_north) {
  const auto rows = static_cast<std::int64_t>(rows_from_north.size());
  BinMask mask(GridSpec{1, 0, 0, rows, static_cast<std::int64_t>(rows_from_north.begin()->size())});
  std::int64_t row = rows;
  for (const std::string_view line : rows_from_north) {
    --row;
    for (std::size_t col = 0; col < line.size(); ++col)
      mask.at({row, static_cast<std::int64_t>(col)}) = line[col] == '#' ? 1 : 0;
  }
  return mask;
}

/// Each bin is set with the given probability.
inline BinMask random_mask(const GridSpec& spec, double set_frac, std::uint64_t seed) {
  const RandomField field(seed, RandomStream::dropout);
  BinMask mask(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) mask.values()[i] = field.uniform(i) < set_frac ? 1 : 0;
  return mask;
}

}  // namespace landfall::testing_masks
