// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D306
#include "chain/draws/variation.h"

#include <array>
#include <cmath>
#include <span>

#include "base/core/hash.h"
#include "base/numerics/random.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

/// The counter of a key's random numbers: 128 bits, so that no two keys share one.
std::array<std::uint64_t, 2> counter_of(const std::string& key) {
  return Hash().update(std::as_bytes(std::span(key))).words();
}

RandomField field_of(RandomSeed seed) { return {seed, RandomStream::variation}; }

std::string owner_of(const std::string& key) { return "vary/" + key; }

}  // namespace

double value(const NormalVariation& variation, const std::string& key, RandomSeed seed) {
  const auto [i, j] = counter_of(key);
  return variation.mean + variation.sigma * field_of(seed).normal(i, j);
}

double value(const UniformVariation& variation, const std::string& key, RandomSeed seed) {
  const auto [i, j] = counter_of(key);
  const double width = variation.high - variation.low;
  // At most `high`: u <= 1 - 2^-53, so that width u is at most the exact width, by however much width is
  // rounded.
  return variation.low + width * field_of(seed).uniform(i, j);
}

void check(const NormalVariation& variation, const std::string& key) {
  require_finite({owner_of(key), "mean"}, variation.mean);
  require_not_negative({owner_of(key), "sigma"}, variation.sigma);
}

void check(const UniformVariation& variation, const std::string& key) {
  require_finite({owner_of(key), "low"}, variation.low);
  require(std::isfinite(variation.high - variation.low) && variation.high >= variation.low,
          {owner_of(key), "high"}, variation.high, "finite and >= low");
}

void check_list(std::size_t value_count, const std::string& key, std::size_t draw_count) {
  if (value_count >= draw_count) return;
  throw UsageError(owner_of(key) + "/values: " + std::to_string(value_count) + " values are fewer than the " +
                   std::to_string(draw_count) + " draws");
}

}  // namespace landfall
