// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/json_leaves.h"

#include <algorithm>
#include <utility>

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Leaves = std::vector<std::pair<std::string, OrderedJson>>;

void add_leaves(const OrderedJson& json, const std::string& path, Leaves& leaves) {
  if (!json.is_object() || json.empty()) {
    if (!path.empty()) leaves.emplace_back(path, json);
    return;
  }
  for (const auto& [key, value] : json.items())
    add_leaves(value, path.empty() ? key : path + "." + key, leaves);
}

Leaves leaves_of(const OrderedJson& json) {
  Leaves leaves;
  add_leaves(json, "", leaves);
  return leaves;
}

std::optional<OrderedJson> find(const Leaves& leaves, const std::string& path) {
  const auto found = std::ranges::find(leaves, path, &Leaves::value_type::first);
  return found == leaves.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

std::vector<ValuePair> value_pairs(const OrderedJson& a, const OrderedJson& b) {
  const Leaves leaves_a = leaves_of(a);
  const Leaves leaves_b = leaves_of(b);
  std::vector<ValuePair> pairs;
  for (const auto& [path, value] : leaves_a) pairs.push_back({path, value, find(leaves_b, path)});
  for (const auto& [path, value] : leaves_b)
    if (!find(leaves_a, path)) pairs.push_back({path, std::nullopt, value});
  return pairs;
}

}  // namespace landfall
