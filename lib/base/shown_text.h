// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>

namespace landfall {

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
