// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace landfall {

/// A text with ? for every byte that is not printable ASCII.
inline std::string plain_ascii(std::string text) {
  for (char& c : text)
    if (c < ' ' || c > '~') c = '?';
  return text;
}

/// A word from a file, shortened for a message: at most 40 bytes of plain ASCII.
inline std::string shown_word(std::string_view word) { return plain_ascii(std::string(word.substr(0, 40))); }

/// Shortens a text that the user typed or that is valid UTF-8: up to 60 bytes are kept whole; a longer text
/// is cut after the last character that fits, and "..." follows.
inline std::string abbreviated(std::string_view text) {
  constexpr std::size_t kMax = 60;
  if (text.size() <= kMax) return std::string(text);
  std::size_t end = kMax - 3;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xc0U) == 0x80U) --end;
  return std::string(text.substr(0, end)) + "...";
}

}  // namespace landfall
