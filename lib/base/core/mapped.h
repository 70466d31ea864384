// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <ranges>
#include <type_traits>
#include <vector>

namespace landfall {

/// of(item) of each item of a list, in its order; `of` may be a member of the items.
template <class List, class Of>
[[nodiscard]] auto mapped(const List& list, Of of) {
  std::vector<std::decay_t<std::invoke_result_t<Of&, std::ranges::range_reference_t<const List>>>> values;
  if constexpr (std::ranges::sized_range<const List>) values.reserve(std::ranges::size(list));
  for (const auto& item : list) values.push_back(std::invoke(of, item));
  return values;
}

}  // namespace landfall
