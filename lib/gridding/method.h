// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "gridding/accumulator.h"

namespace landfall {

/// How returns make a map; docs/user/regrid.md says what each layer then means.
enum class Method {
  bilinear_nearest,  ///< weighted mean of the returns in a bin: the paper's (WeightedMeanAccumulator)
  bilinear4,         ///< each return at the four centres around it (BilinearAccumulator)
  mean,              ///< plain mean (WeightedMeanAccumulator)
  min,               ///< the lowest return (ExtremeAccumulator)
  max,               ///< the highest return (ExtremeAccumulator)
  median,            ///< the median return (MedianAccumulator)
};

[[nodiscard]] std::unique_ptr<Accumulator> make_accumulator(Method method, const GridSpec& spec);

}  // namespace landfall
