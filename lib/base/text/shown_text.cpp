// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/text/shown_text.h"

#include <algorithm>
#include <array>
#include <cstdio>

// Printed text is escaped, and nothing of it removed. Control characters, marks of bidirectional text and
// characters without width become their escapes in JSON (`\u001b`), bytes that are not UTF-8 `\xff`; a
// backslash remains as it is. So different names look different, and printed JSON has the same values. This
// is done where texts are printed, not where they are read: files keep what they hold.

namespace landfall {
namespace {

struct CodeRange {
  char32_t first;
  char32_t last;
};
/// python/landfall/errors.py has the same ranges.
constexpr std::array<CodeRange, 10> kHidden = {{{0x00, 0x1f},
                                                {0x7f, 0x9f},
                                                {0xad, 0xad},
                                                {0x61c, 0x61c},
                                                {0x180e, 0x180e},
                                                {0x200b, 0x200f},
                                                {0x2028, 0x202e},
                                                {0x2060, 0x206f},
                                                {0xfeff, 0xfeff},
                                                {0xfff9, 0xfffb}}};

bool is_hidden(char32_t code) {
  return std::ranges::any_of(kHidden, [=](const CodeRange& r) { return r.first <= code && code <= r.last; });
}

/// A character of UTF-8; `size` is 0 if the bytes are not one.
struct Character {
  char32_t code = 0;
  std::size_t size = 0;
};

Character first_character(std::string_view text) {
  constexpr std::array<char32_t, 5> kFirstOfSize = {0, 0, 0x80, 0x800, 0x10000};
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, 1};
  const std::size_t size = lead >= 0xf8 || lead < 0xc0 ? 0 : lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (size == 0 || text.size() < size) return {};
  char32_t code = lead & (0x7fU >> size);
  for (std::size_t i = 1; i < size; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    if ((byte & 0xc0U) != 0x80U) return {};
    code = code << 6U | (byte & 0x3fU);
  }
  const bool is_surrogate = code >= 0xd800 && code <= 0xdfff;
  if (code < kFirstOfSize.at(size) || code > 0x10ffff || is_surrogate) return {};
  return {code, size};
}

std::string escape(const char* format, unsigned value) {
  std::array<char, 8> text{};
  static_cast<void>(std::snprintf(text.data(), text.size(), format, value));
  return text.data();
}

std::string shown(std::string_view text, bool keeps_lines) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Character next = first_character(text);
    if (next.size == 0)
      result += escape("\\x%02x", static_cast<unsigned char>(text[0]));
    else if (is_hidden(next.code) && !(keeps_lines && next.code == '\n'))
      result += escape("\\u%04x", static_cast<unsigned>(next.code));
    else
      result += text.substr(0, next.size);
    text.remove_prefix(std::max<std::size_t>(next.size, 1));
  }
  return result;
}

}  // namespace

std::string shown_text(std::string_view text) { return shown(text, false); }

std::string shown_lines(std::string_view text) { return shown(text, true); }

}  // namespace landfall
