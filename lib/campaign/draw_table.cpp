// SPDX-License-Identifier: GPL-3.0-or-later
#include "campaign/draw_table.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>

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
  append(table.varied, next.varied);
  append(table.metrics, next.metrics);
  table.pass.insert(table.pass.end(), next.pass.begin(), next.pass.end());
}

const DrawColumn* find_metric(const DrawTable& table, const std::string& name) {
  const auto found = std::ranges::find(table.metrics, name, &DrawColumn::name);
  return found == table.metrics.end() ? nullptr : &*found;
}

const DrawColumn& pass_column(const DrawTable& table, const std::string& requirement) {
  const std::string name = "requirements." + requirement + ".pass";
  if (const DrawColumn* const column = find_metric(table, name)) return *column;
  throw std::out_of_range(name);
}

}  // namespace landfall
