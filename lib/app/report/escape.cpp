// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/escape.h"

#include <cstdint>

#include "base/text/shown_text.h"

namespace landfall::html_report {
namespace {

/// The value with shown_lines() of every text in it, keys too.
nlohmann::ordered_json shown_values(const nlohmann::ordered_json& value) {
  if (value.is_string()) return shown_lines(value.get_ref<const std::string&>());
  nlohmann::ordered_json shown = value;
  if (value.is_array())
    for (auto& entry : shown) entry = shown_values(entry);
  if (value.is_object()) {
    shown = nlohmann::ordered_json::object();
    for (const auto& [key, entry] : value.items()) shown[shown_text(key)] = shown_values(entry);
  }
  return shown;
}

}  // namespace

std::string html_text(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  for (const char c : shown_lines(text)) switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += c;
    }
  return result;
}

std::string script_json(const nlohmann::ordered_json& value, int indent) {
  const std::string text =
      shown_values(value).dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::string result;
  result.reserve(text.size());
  for (const char c : text) {
    if (c == '<') {
      result += "\\u003c";
    } else {
      result += c;
    }
  }
  return result;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](std::size_t k) {
      return i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U;
    };
    const std::uint32_t three = at(0) << 16U | at(1) << 8U | at(2);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? kDigits[three >> (18U - 6U * k) & 63U] : '=';
  }
  return text;
}

}  // namespace landfall::html_report
