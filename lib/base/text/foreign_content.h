// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace landfall {

/// True for text in UTF-16, with a byte order mark or recognised by the zeros between ASCII characters.
inline bool is_utf16(std::string_view bytes) {
  if (bytes.substr(0, 2) == "\xFF\xFE" || bytes.substr(0, 2) == "\xFE\xFF") return true;
  if (bytes.size() < 4) return false;
  const auto is_ascii_pair = [](char text, char zero) { return zero == '\0' && text >= '\t' && text <= '~'; };
  return (is_ascii_pair(bytes[0], bytes[1]) && is_ascii_pair(bytes[2], bytes[3])) ||
         (is_ascii_pair(bytes[1], bytes[0]) && is_ascii_pair(bytes[3], bytes[2]));
}

/// The kind of a file that is certainly not the text that a reader expects, and what to do: "is UTF-16
/// text: save it as UTF-8". Empty if nothing is known. `bytes`: the beginning of the file.
inline std::string foreign_content(std::string_view bytes) {
  using namespace std::string_view_literals;
  struct Kind {
    std::string_view begin;
    const char* what;
  };
  static constexpr std::array kKinds = {
      Kind{"\x1F\x8B"sv, "is compressed by gzip: unpack it with gunzip"},
      Kind{"BZh"sv, "is compressed by bzip2: unpack it with bunzip2"},
      Kind{"\xFD"
           "7zXZ"sv,
           "is compressed by xz: unpack it with unxz"},
      Kind{"\x28\xB5\x2F\xFD"sv, "is compressed by zstd: unpack it with unzstd"},
      Kind{"PK\x03\x04"sv,
           "is a zip archive, as .xlsx and .ods workbooks are: save a sheet as CSV, or unzip it"},
      Kind{"\xD0\xCF\x11\xE0"sv, "is an .xls workbook: save a sheet as CSV"},
      Kind{"MATLAB 5.0 MAT-file"sv, "is a MATLAB file of version 7 or older: save it with -v7.3, or as CSV"},
      Kind{"\x93NUMPY"sv, "is a NumPy array: write text with numpy.savetxt"}};
  for (const Kind& kind : kKinds)
    if (bytes.substr(0, kind.begin.size()) == kind.begin) return kind.what;
  return is_utf16(bytes) ? "is UTF-16 text: save it as UTF-8" : "";
}

/// The text without a UTF-8 byte order mark, with which some programs begin a file.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  return text.substr(text.substr(0, kMark.size()) == kMark ? kMark.size() : 0);
}

}  // namespace landfall
