// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/numerics/random_seed.h"

namespace landfall {

// How a key of a configuration varies from draw to draw. The values of a key depend only on the key's text,
// its own parameters and the seed of the draw: other varied keys, the number of draws and the order in which
// they are computed change nothing (docs/reference/draws.md).

/// Normally distributed, within 8.6 sigma of the mean.
struct NormalVariation {
  double mean = 0;
  double sigma = 1;
  friend bool operator==(const NormalVariation&, const NormalVariation&) = default;
};

/// Uniformly distributed in [low, high].
struct UniformVariation {
  double low = 0;
  double high = 1;
  friend bool operator==(const UniformVariation&, const UniformVariation&) = default;
};

/// Element i in draw i.
template <class Value>
struct ListVariation {
  std::vector<Value> values;
  friend bool operator==(const ListVariation&, const ListVariation&) = default;
};

/// `Value` is made from a double: double itself, or a JSON value in a folder that reads configurations.
template <class Value>
using Variation = std::variant<NormalVariation, UniformVariation, ListVariation<Value>>;

/// The value of `key` in a draw of a run. The same bits on every machine.
[[nodiscard]] double value(const NormalVariation& variation, const std::string& key, RandomSeed seed);
[[nodiscard]] double value(const UniformVariation& variation, const std::string& key, RandomSeed seed);

/// As above. A list must have an element for the draw, as check() assures.
template <class Value>
[[nodiscard]] Value value(const Variation<Value>& variation, const std::string& key, RandomSeed seed) {
  return std::visit(
      [&](const auto& kind) -> Value {
        if constexpr (std::is_same_v<decltype(kind), const ListVariation<Value>&>) {
          return kind.values.at(seed.draw);
        } else {
          return landfall::value(kind, key, seed);
        }
      },
      variation);
}

/// Throws UsageError "vary/KEY/sigma: ..." unless all parameters are finite, `sigma` is not negative and
/// `high` is at least `low`.
void check(const NormalVariation& variation, const std::string& key);
void check(const UniformVariation& variation, const std::string& key);
/// Throws UsageError "vary/KEY/values: ..." unless each draw has a value.
void check_list(std::size_t value_count, const std::string& key, std::size_t draw_count);

template <class Value>
void check(const Variation<Value>& variation, const std::string& key, std::size_t draw_count) {
  std::visit(
      [&](const auto& kind) {
        if constexpr (std::is_same_v<decltype(kind), const ListVariation<Value>&>) {
          check_list(kind.values.size(), key, draw_count);
        } else {
          check(kind, key);
        }
      },
      variation);
}

}  // namespace landfall
