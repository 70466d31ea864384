// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/raster/layer_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::size_t kValuesPerTask = std::size_t{1} << 18U;

/// The index of the first of the values that is not in [least, most]; kNone without one. NaN counts as valid.
template <class T>
std::size_t first_outside(std::span<const T> values, T minimum, T maximum) {
  std::vector<std::size_t> found((values.size() + kValuesPerTask - 1) / kValuesPerTask, kNone);
  parallel_for(values.size(), kValuesPerTask, [&](std::size_t begin, std::size_t end) {
    const auto piece = values.subspan(begin, end - begin);
    const auto first = std::ranges::find_if(piece, [&](T v) { return v < minimum || v > maximum; });
    if (first != piece.end())
      found[begin / kValuesPerTask] = begin + static_cast<std::size_t>(first - piece.begin());
  });
  const auto first = std::ranges::min_element(found);
  return first == found.end() ? kNone : *first;
}

}  // namespace

template <class T>
void require_values(const Grid<T>& layer, const std::string& name, LayerValues allowed,
                    std::int64_t first_row) {
  const T minimum = allowed == LayerValues::finite ? std::numeric_limits<T>::lowest() : T{0};
  const std::size_t index = first_outside<T>(layer.values(), minimum, std::numeric_limits<T>::max());
  if (index == kNone) return;
  const auto value = static_cast<double>(layer.values()[index]);
  const auto cols = static_cast<std::size_t>(layer.spec().cols);
  throw FormatError(
      name + ": the value in row " + std::to_string(first_row + static_cast<std::int64_t>(index / cols)) +
      ", column " + std::to_string(index % cols) +
      (std::isinf(value) ? " is infinite" : " is " + short_number(value) + ", and must be 0 or more"));
}

template void require_values(const Grid<double>&, const std::string&, LayerValues, std::int64_t);
template void require_values(const Grid<float>&, const std::string&, LayerValues, std::int64_t);
template void require_values(const Grid<std::int32_t>&, const std::string&, LayerValues, std::int64_t);

}  // namespace landfall
