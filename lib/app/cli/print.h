// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <string>

namespace landfall::cli {

/// As printf ("%ld" for an std::int64_t), cut after 255 bytes.
template <class... Values>
std::string print(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

/// A number of at most 8 characters, as far as an exponent leaves room for digits.
[[nodiscard]] inline std::string statistic_text(double value) {
  std::string text;
  for (int digits = 4; digits > 1 && (text.empty() || text.size() > 8); --digits)
    text = print("%.*g", digits, value);
  return text;
}

/// The columns of the terminal on standard output; none where it is not a terminal.
[[nodiscard]] inline std::optional<std::size_t> terminal_width() {
  winsize size{};
  if (isatty(STDOUT_FILENO) == 0 || ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0)
    return std::nullopt;
  return size.ws_col;
}

/// The width of tables and wrapped text: the columns of the terminal, between 60 and 120; 80 where standard
/// output is not a terminal.
[[nodiscard]] inline std::size_t page_width() {
  return std::clamp<std::size_t>(terminal_width().value_or(80), 60, 120);
}

/// A text of at most `width` columns, 4 or more, that ends in "..." if it was longer. A number or a word is
/// left out whole rather than cut, unless that leaves less than half of the width; no letter of UTF-8 is cut.
[[nodiscard]] inline std::string shortened(const std::string& text, std::size_t width) {
  if (text.size() <= width) return text;
  const auto in_word = [&](std::size_t i) {
    return std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '.' || text[i] == '-' ||
           text[i] == '+' || text[i] == '_';
  };
  std::size_t end = width - 3;
  std::size_t word = end;
  while (word > width / 2 && in_word(word) && in_word(word - 1)) --word;
  if (word > width / 2) end = word;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
  return text.substr(0, end) + "...";
}

/// A line for the terminal, shortened() to its columns less `indent`; complete where standard output is a
/// file or a pipe.
[[nodiscard]] inline std::string fitted(const std::string& text, std::size_t indent = 0) {
  const std::optional<std::size_t> width = terminal_width();
  return width ? shortened(text, std::max<std::size_t>(*width, indent + 20) - indent) : text;
}

}  // namespace landfall::cli
