// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/table_columns.h"

#include <algorithm>

#include "base/text/characters.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

std::vector<std::size_t> positions_of(const std::string& wanted, const std::vector<std::string>& names) {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (lower_case(names[i]) == lower_case(wanted)) positions.push_back(i);
  return positions;
}

}  // namespace

std::string name_list(const std::vector<std::string>& names) {
  constexpr std::size_t kMaxLength = 200;
  std::string list;
  for (const std::string& name : names) {
    if (list.size() > kMaxLength) return list + ", ...";
    list += (list.empty() ? "" : ", ") + (name.empty() ? "''" : plain_ascii(abbreviated(name)));
  }
  return list;
}

std::string needed_columns(const TableColumns& wanted) {
  return wanted.required.empty() ? "the names of its columns" : "the columns " + name_list(wanted.required);
}

bool has_columns(const std::vector<std::string>& names, const TableColumns& wanted) {
  return (!wanted.all || !names.empty()) &&
         std::ranges::all_of(wanted.required,
                             [&](const std::string& name) { return !positions_of(name, names).empty(); });
}

std::vector<MatchedColumn> matched_columns(const std::vector<std::string>& names, const TableColumns& wanted,
                                           const std::function<void(const std::string&)>& fail) {
  std::vector<MatchedColumn> matched;
  std::vector<std::string> missing;
  const auto take = [&](const std::string& name) {
    const std::vector<std::size_t> positions = positions_of(name, names);
    if (positions.size() > 1)
      fail("column " + shown_word(name) + " is given twice, as '" + shown_word(names[positions[0]]) +
           "' and '" + shown_word(names[positions[1]]) + "'");
    if (!positions.empty()) matched.push_back({lower_case(name), positions[0]});
    return !positions.empty();
  };
  for (const std::string& name : wanted.required)
    if (!take(name)) missing.push_back(name);
  if (!missing.empty())
    fail("no column " + name_list(missing) + "; it has " + (names.empty() ? "none" : name_list(names)) +
         " and needs " + name_list(wanted.required));
  for (const std::string& name : wanted.optional) take(name);
  if (!wanted.all) return matched;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i].empty()) fail("column " + std::to_string(i + 1) + " has no name");
    take(names[i]);
  }
  return matched;
}

}  // namespace landfall
