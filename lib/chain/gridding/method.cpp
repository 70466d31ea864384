// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/method.h"

#include <stdexcept>

#include "chain/gridding/accumulators.h"
#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {

std::unique_ptr<Accumulator> make_accumulator(Method method, const GridSpec& spec) {
  using enum Method;
  switch (method) {
    case bilinear_nearest:
      return std::make_unique<WeightedMeanAccumulator>(spec, WeightedMeanAccumulator::Weights::bilinear);
    case bilinear4:
      return std::make_unique<BilinearAccumulator>(spec);
    case mean:
      return std::make_unique<WeightedMeanAccumulator>(spec, WeightedMeanAccumulator::Weights::equal);
    case min:
      return std::make_unique<ExtremeAccumulator>(spec, ExtremeAccumulator::Which::lowest);
    case max:
      return std::make_unique<ExtremeAccumulator>(spec, ExtremeAccumulator::Which::highest);
    case median:
      return std::make_unique<MedianAccumulator>(spec);
  }
  throw std::logic_error("no such method");
}

}  // namespace landfall
