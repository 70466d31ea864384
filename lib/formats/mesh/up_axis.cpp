// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D441
#include "formats/mesh/up_axis.h"

#include <algorithm>
#include <cctype>
#include <initializer_list>

#include "base/text/parsed_number.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

/// The words of a line in lower case, each between blanks: " y up "; signs and digits belong to words.
std::string words_of(std::string_view line) {
  std::string words = " ";
  for (const char c : line) {
    const bool is_of_word =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == '+';
    if (is_of_word)
      words += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    else if (words.back() != ' ')
      words += ' ';
  }
  return words.back() == ' ' ? words : words + ' ';
}

bool has_any(const std::string& words, std::initializer_list<const char*> phrases) {
  return std::ranges::any_of(phrases,
                             [&](const char* phrase) { return words.find(phrase) != std::string::npos; });
}

bool says_up(std::string words, char axis) {
  std::erase(words, '+');
  std::ranges::replace(words, '-', ' ');  // y-up
  const std::string a(1, axis);
  const std::string phrases[] = {" " + a + " up ",      " " + a + "up ",          " " + a + " is up ",
                                 " up " + a + " ",      " up axis " + a + " ",    " upaxis " + a + " ",
                                 " axis up " + a + " ", " " + a + " axis is up ", " " + a + " axis up "};
  return std::ranges::any_of(
      phrases, [&](const std::string& phrase) { return words.find(phrase) != std::string::npos; });
}

/// The numbers behind a word that says that something is to be added; whether one of at least two is not 0.
bool has_offset(const std::string& words) {
  for (const char* const word :
       {" offset ", " offsets ", " shift ", " globalshift ", " origin ", " translation "}) {
    std::size_t at = words.find(word);
    if (at == std::string::npos) continue;
    std::size_t count = 0;
    bool is_moved = false;
    for (at = words.find(' ', at + 1); at + 1 < words.size();) {
      const std::size_t end = words.find(' ', at + 1);
      const ParsedNumber number = parsed_number(std::string_view(words).substr(at + 1, end - at - 1));
      at = end;
      if (number.outcome != ParsedNumber::Outcome::number) continue;
      ++count;
      is_moved = is_moved || number.value != 0;
    }
    if (count >= 2 && is_moved) return true;
  }
  return false;
}

/// The text of a comment; empty for another line.
std::string_view comment_in(std::string_view line) {
  for (const std::string_view mark : {"comment ", "obj_info ", "#", "//", "%"})
    if (line.starts_with(mark)) return line.substr(mark.size());
  return {};
}

}  // namespace

PlaceComments place_comments(std::string_view text) {
  text = text.substr(0, kHeadOfComments);
  PlaceComments found;
  bool is_z_up = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with("end_header") || line.starts_with("DATA ")) break;
    const std::string_view comment = comment_in(line);
    if (comment.empty()) continue;
    const std::string words = words_of(comment);
    is_z_up = is_z_up || says_up(words, 'z');
    const bool is_y_up = says_up(words, 'y') || (line.front() == '#' && has_any(words, {" blender "}));
    if (is_y_up && found.y_up.empty()) found.y_up = shown_word(line);
    if (found.offset.empty() && has_offset(words)) found.offset = shown_word(line);
  }
  if (is_z_up) found.y_up.clear();
  return found;
}

bool stands_on_edge(const std::array<double, 3>& extent) {
  constexpr double kFar = 4;
  return extent[2] > kFar * extent[1] && extent[0] > kFar * extent[1] && kFar * extent[2] > extent[0];
}

std::vector<std::string> place_warnings(const PlaceComments& comments, bool on_edge, bool up_is_given,
                                        const std::string& offset_remedy) {
  std::vector<std::string> warnings;
  if (!up_is_given && !comments.y_up.empty())
    warnings.push_back("its comment '" + comments.y_up +
                       "' says that y is up, but z is taken as up: --up y turns it, --up z confirms");
  else if (!up_is_given && on_edge)
    warnings.emplace_back(
        "it stands on edge like a wall, far longer in x and z than in y: if its y is up, --up y turns it; "
        "--up z confirms");
  if (!comments.offset.empty())
    warnings.push_back("its comment '" + comments.offset + "' is not applied" + offset_remedy);
  return warnings;
}

}  // namespace landfall
