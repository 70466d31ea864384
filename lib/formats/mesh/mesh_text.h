// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/core/error.h"
#include "base/text/parsed_number.h"
#include "base/text/shown_text.h"
#include "base/text/split_text.h"
#include "chain/terrain/mesh/polygon_soup.h"

namespace landfall {

/// Reads words and lines of a text mesh file. Lines end with LF, CR LF or CR.
class MeshText {
 public:
  MeshText(std::string_view text, const std::string& name, std::size_t at = 0)
      : text_(text), name_(name), at_(at) {
    const std::size_t end = text.find_first_of("\r\n");
    cr_alone_ = end != std::string_view::npos && text[end] == '\r' && text.substr(end + 1, 1) != "\n";
  }

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
      while (at_ < text_.size() && is_space(text_[at_]) && !is_line_end(text_[at_])) ++at_;
      const std::size_t next = joined_line();
      if (next == 0) return word_here();
      at_ = next;
    }
  }

  /// Goes to the beginning of the next line. Where the first line of the text ends with CR alone, so does
  /// this one: a LF after it may be the first byte of binary data.
  void skip_line() {
    while (at_ < text_.size() && !is_line_end(text_[at_])) ++at_;
    if (at_ < text_.size()) at_ += !cr_alone_ && text_.substr(at_, 2) == "\r\n" ? 2U : 1U;
  }

  [[nodiscard]] double number(std::string_view word) const {
    const ParsedNumber parsed = parsed_number(word);
    if (parsed.outcome == ParsedNumber::Outcome::not_a_number)
      fail("'" + shown_word(word) + "' is not a number");
    if (parsed.outcome == ParsedNumber::Outcome::too_large)
      fail("'" + shown_word(word) + "' is beyond double precision");
    return parsed.value;
  }

  [[nodiscard]] std::int64_t integer(std::string_view word) const {
    const std::string_view digits = word.substr(!word.empty() && word.front() == '+' ? 1 : 0);
    const auto value = exact_number<std::int64_t>(digits);
    if (!value) fail("'" + shown_word(word) + "' is not an integer");
    return *value;
  }

  Eigen::Vector3d point_of_line() {
    const double x = number(word_of_line());
    const double y = number(word_of_line());
    return {x, y, number(word_of_line())};
  }

  /// The numbers that remain on this line, up to a comment.
  std::vector<double> numbers_of_line() {
    std::vector<double> numbers;
    for (std::string_view word = word_of_line(); !word.empty() && word.front() != '#'; word = word_of_line())
      numbers.push_back(number(word));
    return numbers;
  }

  /// Refuses a word after the last element of the file.
  void require_end() {
    for (std::string_view rest = word(); !rest.empty(); rest = word()) {
      if (rest.front() != '#')
        fail("'" + shown_word(rest) + "' follows the last element that the file declares");
      skip_line();
    }
  }

  /// "NAME: line 12: what".
  [[noreturn]] void fail(const std::string& what) const {
    std::size_t line = 1;
    for (const char c : text_.substr(0, at_)) line += c == (cr_alone_ ? '\r' : '\n') ? 1U : 0U;
    throw FormatError(name_ + ": line " + std::to_string(line) + ": " + what);
  }

 private:
  [[nodiscard]] static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  [[nodiscard]] static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

  std::string_view word_here() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_]) && joined_line() == 0) ++at_;
    return text_.substr(begin, at_ - begin);
  }

  /// The beginning of the next line if a backslash here joins it; else 0.
  [[nodiscard]] std::size_t joined_line() const {
    if (!joins_lines_ || at_ >= text_.size() || text_[at_] != '\\') return 0;
    if (text_.substr(at_ + 1, 2) == "\r\n") return at_ + 3;
    return at_ + 1 < text_.size() && is_line_end(text_[at_ + 1]) ? at_ + 2 : 0;
  }

  std::string_view text_;
  std::string name_;
  std::size_t at_;
  bool joins_lines_ = false;
  bool cr_alone_ = false;  ///< the first line ends with CR alone
};

/// Ends the polygon whose corners were added last. `fail` reports a polygon that is not a facet.
template <class Fail>
void end_polygon(PolygonSoup& soup, const Fail& fail) {
  const std::size_t corners =
      soup.corners.size() - (soup.polygon_ends.empty() ? 0 : soup.polygon_ends.back());
  if (corners < 3)
    fail("a facet of " + std::to_string(corners) + " corners; a terrain has no points and lines: remove it");
  soup.polygon_ends.push_back(soup.corners.size());
}

/// The index of a point as soups store it; `fail` reports any invalid number.
template <class Fail>
std::uint32_t point_number(std::int64_t value, const Fail& fail) {
  if (value < 0 || value >= static_cast<std::int64_t>(kMaxMeshElements))
    fail("a facet names vertex number " + std::to_string(value) + ", counted from 0");
  return static_cast<std::uint32_t>(value);
}

}  // namespace landfall
