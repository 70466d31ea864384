// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "chain/gridding/accumulator.h"

namespace landfall {

/// How a map is made from returns; docs/user/regrid.md defines each layer for each method.
enum class Method {
  bilinear_nearest,  ///< weighted mean of the returns in a bin, as in the paper (WeightedMeanAccumulator)
  bilinear4,         ///< each return at the four centres around it (BilinearAccumulator)
  mean,              ///< plain mean (WeightedMeanAccumulator)
  min,               ///< the lowest return (ExtremeAccumulator)
  max,               ///< the highest return (ExtremeAccumulator)
  median,            ///< the median return (MedianAccumulator)
};

[[nodiscard]] std::unique_ptr<Accumulator> make_accumulator(Method method, const GridSpec& spec);

}  // namespace landfall
