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

/// A text from anywhere, as it may be printed: what could move the cursor, change colours or hide, reverse or
/// imitate other characters becomes its escape in JSON, such as \u001b. These are the control characters (C0,
/// DEL, C1), the marks of bidirectional text, line and paragraph separators, the soft hyphen, and characters
/// without width. A byte that is not UTF-8 becomes \xNN. All other characters remain, a backslash too.
///
/// Every message, log, table and description passes through here where it is printed;
/// python/landfall/errors.py does the same.
[[nodiscard]] std::string shown_text(std::string_view text);

/// shown_text() of each line; the line feeds remain. For a text of several lines, and for JSON, which then
/// still has the same values.
[[nodiscard]] std::string shown_lines(std::string_view text);

}  // namespace landfall
