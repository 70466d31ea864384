// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/draw_table.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "base/dictionary/tables/requirements.h"

namespace landfall {
namespace {

void append(std::vector<DrawColumn>& columns, const std::vector<DrawColumn>& next) {
  assert(columns.size() == next.size());
  for (std::size_t i = 0; i < columns.size(); ++i)
    columns[i].values.insert(columns[i].values.end(), next[i].values.begin(), next[i].values.end());
}

}  // namespace

void append(DrawTable& table, const DrawTable& next) {
  assert(next.first == table.end());
  table.seeds.insert(table.seeds.end(), next.seeds.begin(), next.seeds.end());
  table.draws.insert(table.draws.end(), next.draws.begin(), next.draws.end());
  append(table.varied, next.varied);
  append(table.metrics, next.metrics);
  table.pass.insert(table.pass.end(), next.pass.begin(), next.pass.end());
}

const DrawColumn* find_metric(const DrawTable& table, const std::string& name) {
  const auto found = std::ranges::find(table.metrics, name, &DrawColumn::name);
  return found == table.metrics.end() ? nullptr : &*found;
}

std::vector<OwnColumn> own_columns(const DrawTable& table) {
  constexpr std::string_view kEnd = ".pass";
  std::vector<OwnColumn> own;
  for (const DrawColumn& column : table.metrics)
    for (const std::string_view begin : {"own_requirements.", "score.own_requirements."})
      if (column.name.starts_with(begin) && column.name.ends_with(kEnd))
        own.push_back({column.name.substr(begin.size(), column.name.size() - begin.size() - kEnd.size()),
                       column.name.substr(0, column.name.size() - kEnd.size()), &column});
  return own;
}

std::vector<std::int8_t> six_passed(const DrawTable& table) {
  std::vector<std::int8_t> passed(table.pass.size(), pass_flag(true));
  for (const dictionary::Requirement& words : dictionary::kRequirements) {
    const std::vector<double>& passes = pass_column(table, words.name).values;
    for (std::size_t i = 0; i < passed.size(); ++i) {
      if (std::isnan(passes[i]) && passed[i] == pass_flag(true)) passed[i] = pass_flag(std::nullopt);
      if (passes[i] == 0) passed[i] = pass_flag(false);
    }
  }
  return passed;
}

std::int64_t judged_draws(const DrawTable& table, const std::string& requirement) {
  return std::ranges::count_if(pass_column(table, requirement).values,
                               [](double pass) { return !std::isnan(pass); });
}

const DrawColumn& pass_column(const DrawTable& table, const std::string& requirement) {
  const std::string name = "requirements." + requirement + ".pass";
  if (const DrawColumn* const column = find_metric(table, name)) return *column;
  throw std::out_of_range(name);
}

}  // namespace landfall
