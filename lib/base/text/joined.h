// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <string_view>

namespace landfall {

/// text_of(item) of each item of a list, with `between` between each two: "a, b, c". Empty texts are left
/// out.
template <class List, class TextOf = std::identity>
[[nodiscard]] std::string joined(const List& list, std::string_view between = ", ", TextOf text_of = {}) {
  std::string result;
  for (const auto& item : list) {
    const std::string text(std::invoke(text_of, item));
    if (text.empty()) continue;
    if (!result.empty()) result += between;
    result += text;
  }
  return result;
}

}  // namespace landfall
