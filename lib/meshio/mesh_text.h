// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <charconv>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <system_error>

#include "base/abbreviated.h"
#include "base/error.h"
#include "terrain/mesh/polygon_soup.h"

namespace landfall {

/// Reads words and lines of a text mesh file.
class MeshText {
 public:
  MeshText(std::string_view text, const std::string& name, std::size_t at = 0)
      : text_(text), name_(name), at_(at) {}

  /// From here on, a backslash at the end of a line joins the next line to it, as in OBJ.
  void join_lines() { joins_lines_ = true; }

  [[nodiscard]] bool at_end() const { return at_ >= text_.size(); }
  [[nodiscard]] std::size_t position() const { return at_; }

  /// The next word, on this line or a later one; empty at the end.
  std::string_view word() {
    while (at_ < text_.size() && is_space(text_[at_])) ++at_;
    return word_here();
  }

  /// The next word of this line; empty at its end.
  std::string_view word_of_line() {
    for (;;) {
      while (at_ < text_.size() && is_space(text_[at_]) && text_[at_] != '\n') ++at_;
      const std::size_t next = joined_line();
      if (next == 0) return word_here();
      at_ = next;
    }
  }

  /// Goes to the beginning of the next line.
  void skip_line() {
    while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    if (at_ < text_.size()) ++at_;
  }

  [[nodiscard]] double number(std::string_view word) const {
    const std::string_view digits = word.substr(!word.empty() && word.front() == '+' ? 1 : 0);
    double value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    const bool is_tiny = error == std::errc::result_out_of_range;  // or too large
    if ((error != std::errc() && !is_tiny) || end != digits.data() + digits.size() || digits.empty())
      fail("'" + shown_word(word) + "' is not a number");
    if (is_tiny) fail("'" + shown_word(word) + "' is beyond double precision");
    return value;
  }

  [[nodiscard]] std::int64_t integer(std::string_view word) const {
    const std::string_view digits = word.substr(!word.empty() && word.front() == '+' ? 1 : 0);
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (error != std::errc() || end != digits.data() + digits.size() || digits.empty())
      fail("'" + shown_word(word) + "' is not an integer");
    return value;
  }

  Eigen::Vector3d point_of_line() {
    const double x = number(word_of_line());
    const double y = number(word_of_line());
    return {x, y, number(word_of_line())};
  }

  /// "NAME: line 12: what".
  [[noreturn]] void fail(const std::string& what) const {
    std::size_t line = 1;
    for (const char c : text_.substr(0, at_)) line += c == '\n' ? 1U : 0U;
    throw FormatError(name_ + ": line " + std::to_string(line) + ": " + what);
  }

 private:
  [[nodiscard]] static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string_view word_here() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && joined_line() == 0) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// The beginning of the next line if a backslash here joins it; else 0.
  [[nodiscard]] std::size_t joined_line() const {
    if (!joins_lines_ || at_ >= text_.size() || text_[at_] != '\\') return 0;
    const std::size_t end = at_ + (text_.substr(at_ + 1, 1) == "\r" ? 2 : 1);
    return text_.substr(end, 1) == "\n" ? end + 1 : 0;
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_;
  bool joins_lines_ = false;
};

/// The index of a point as soups store it; `fail` reports any invalid number.
template <class Fail>
std::uint32_t point_number(std::int64_t value, const Fail& fail) {
  if (value < 0 || value >= static_cast<std::int64_t>(kMaxMeshElements))
    fail("a facet names vertex number " + std::to_string(value) + ", counted from 0");
  return static_cast<std::uint32_t>(value);
}

}  // namespace landfall
