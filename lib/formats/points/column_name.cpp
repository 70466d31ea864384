// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/column_name.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/text/characters.h"
#include "base/units/spelled_unit.h"

namespace landfall {
namespace {

constexpr std::string_view kOpen = "([{<";
constexpr std::string_view kClose = ")]}>";

bool is_word_byte(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || static_cast<unsigned char>(c) > 127;
}

std::vector<std::string> name_words(std::string_view name) {
  std::vector<std::string> words;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (!is_word_byte(name[i])) continue;
    if (i == 0 || !is_word_byte(name[i - 1])) words.emplace_back();
    words.back() += name[i];
  }
  return words;
}

std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += c;
  plain = lower_case(plain);
  return plain.starts_with("scalar") && plain.size() > 6 ? plain.substr(6) : plain;
}

/// True for the names of longitudes and latitudes, those of LVIS ("GLON") among them.
bool says_degrees(std::string_view name) {
  constexpr std::array<std::string_view, 10> kWords = {"lon",  "lat",  "long", "lng",  "glon",
                                                       "glat", "hlon", "hlat", "tlon", "tlat"};
  const auto is_angle = [&](const std::string& word) {
    const std::string folded = lower_case(word);
    return std::ranges::find(kWords, folded) != kWords.end() || folded.find("longitude") != folded.npos ||
           folded.find("latitude") != folded.npos;
  };
  return std::ranges::any_of(name_words(name), is_angle);
}

/// A unit, also one with the name of a datum behind it: "m NAVD88". Text that is certainly none is kept from
/// UDUNITS.
SpelledUnit read_unit(const std::string& text) {
  constexpr std::size_t kMaxUnit = 40;
  if (text.size() > kMaxUnit || std::ranges::any_of(text, [](unsigned char c) { return c < ' '; })) return {};
  const SpelledUnit unit = spelled_unit(text);
  const std::size_t blank = text.find(' ');
  if (unit.is_known() || blank == std::string::npos) return unit;
  const auto is_of_datum = [](unsigned char c) {
    return c == ' ' || std::isupper(c) != 0 || std::isdigit(c) != 0;
  };
  return std::all_of(text.begin() + static_cast<std::ptrdiff_t>(blank), text.end(), is_of_datum)
             ? spelled_unit(text.substr(0, blank))
             : unit;
}

double snapped(double factor) { return std::abs(factor - 1) < 1e-12 ? 1 : factor; }

/// The unit that `text` spells, of a column whose name is otherwise `name`.
ColumnUnit unit_of(std::string_view name, const std::string& text) {
  using enum ColumnUnit::Kind;
  const bool has_degrees = says_degrees(name);
  if (says_no_unit(text)) return {.kind = has_degrees ? angle : unstated};
  const SpelledUnit unit = read_unit(text);
  if (unit.metres > 0 && !has_degrees)
    return {.kind = length, .factor = snapped(unit.downwards ? -unit.metres : unit.metres), .text = text};
  if (unit.radians > 0)
    return {.kind = angle, .factor = snapped(unit.radians * 180 / std::numbers::pi), .text = text};
  if (unit.seconds > 0 && !has_degrees) return {.kind = time, .factor = snapped(unit.seconds), .text = text};
  return {.kind = unknown, .text = text};
}

/// The text of the last brackets that hold a unit, else of the first ones.
std::string bracketed(std::string_view name) {
  std::string found;
  for (std::size_t open = name.find_first_of(kOpen); open != std::string_view::npos;
       open = name.find_first_of(kOpen, open + 1)) {
    const std::size_t close = std::min(name.find(kClose[kOpen.find(name[open])], open), name.size());
    std::string text(name.substr(open + 1, close - open - 1));
    if (found.empty() || read_unit(text).is_known()) found = std::move(text);
  }
  return found;
}

/// "Points_m_XYZ:0" and "Points:0", as ParaView and VeloView write the coordinates of points into tables.
std::optional<NameReading> coordinate_of_points(std::string_view name) {
  std::vector<std::string> words = name_words(name);
  if (words.size() < 2 || words.size() > 4 || lower_case(words.front()) != "points") return std::nullopt;
  if (words.back() != "0" && words.back() != "1" && words.back() != "2") return std::nullopt;
  const auto axis = static_cast<std::size_t>(words.back()[0] - '0');
  words = {words.begin() + 1, words.end() - 1};
  std::erase_if(words, [](const std::string& word) { return lower_case(word) == "xyz"; });
  return NameReading{std::string(1, "xyz"[axis]), unit_of("", words.empty() ? "" : words.front())};
}

/// Units behind a separator. A point of typography is a length to UDUNITS, but "x_point" is not one.
void add_suffixes(std::string_view name, std::vector<NameReading>& readings) {
  for (std::size_t i = 1; i + 1 < name.size(); ++i) {
    if (is_word_byte(name[i]) || !is_word_byte(name[i + 1])) continue;
    std::string_view before = name.substr(0, i);
    std::string text(name.substr(i + 1));
    while (!is_word_byte(text.back())) text.pop_back();
    if (const std::vector<std::string> words = name_words(before); words.size() > 1 && words.back() == "in")
      before = name.substr(0, before.rfind("in"));
    ColumnUnit unit = unit_of(before, text);
    const bool is_known = unit.kind != ColumnUnit::Kind::unknown && unit.kind != ColumnUnit::Kind::unstated;
    if (is_known && lower_case(text) != "point")
      readings.push_back({plain_name(before), std::move(unit), true});
  }
}

}  // namespace

std::vector<NameReading> readings_of(std::string_view name) {
  if (auto coordinate = coordinate_of_points(name)) return {std::move(*coordinate)};
  const std::size_t open = name.find_first_of(kOpen);
  if (open != std::string_view::npos && open > 0) {
    const std::string_view before = name.substr(0, open);
    return {{plain_name(before), unit_of(before, bracketed(name))}};
  }
  std::vector<NameReading> readings = {{plain_name(name), unit_of(name, "")}};
  add_suffixes(name, readings);
  return readings;
}

}  // namespace landfall
