// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

namespace landfall {

/// The parts of a text between separators: "a", "" and "b" of "a,,b"; one empty part of an empty text.
[[nodiscard]] inline std::vector<std::string> split_at(std::string_view text, char separator) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.emplace_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// The words of a text, which white space divides.
[[nodiscard]] inline std::vector<std::string> split_words(const std::string& text) {
  std::istringstream words(text);
  return std::vector<std::string>(std::istream_iterator<std::string>(words), {});
}

/// The number that a whole text writes, without blanks and plus sign; none where T cannot hold it.
template <class T>
[[nodiscard]] std::optional<T> exact_number(std::string_view text) {
  T value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

}  // namespace landfall
