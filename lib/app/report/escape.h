// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>

namespace landfall::html_report {

/// Escapes a text for the content of an element or a quoted attribute: & < > " ' as character references,
/// control characters and marks of bidirectional text as shown_lines() does.
[[nodiscard]] std::string html_text(std::string_view text);

/// JSON that is safe within a <script> element: every < is \u003c, so that neither </script> nor <!-- can end
/// or change it. Texts are those of shown_lines(), so that a byte that is not UTF-8 becomes \xNN; a number
/// that is not finite becomes null.
[[nodiscard]] std::string script_json(const nlohmann::ordered_json& value, int indent = -1);

/// RFC 4648, padded, one line.
[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

}  // namespace landfall::html_report
