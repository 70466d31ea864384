// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace landfall {

/// One number of each draw.
struct DrawColumn {
  std::string name;  ///< the varied key, or the dotted path of the metric in metrics.json
  std::vector<double> values;
  friend bool operator==(const DrawColumn&, const DrawColumn&) = default;
};

/// The draws of a run or of a part of it, a row each.
struct DrawTable {
  std::int64_t first = 0;  ///< number of the first draw
  // The random numbers of each draw (RandomSeed):
  std::vector<std::int64_t> seeds;
  std::vector<std::int64_t> draws;
  std::vector<DrawColumn> varied;
  std::vector<DrawColumn> metrics;  ///< NaN for a number that metrics.json has as null
  std::vector<std::int8_t> pass;    ///< pass_flag() of all requirements, the user's own too

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(seeds.size()); }
  /// Number after the last draw.
  [[nodiscard]] std::int64_t end() const { return first + size(); }
  friend bool operator==(const DrawTable&, const DrawTable&) = default;
};

/// The varied column with the number of the scan, in a run of draws over several scans.
inline constexpr const char* kPairColumn = "pair";

/// Metrics of a run whose draws land: whether the landing is safe, 0 or 1.
inline constexpr const char* kLandingSafe = "landing.safe";
inline constexpr const char* kBlindSafe = "blind.safe";

/// Appends `next`, whose first draw follows the last one of `table` and which has the same columns.
void append(DrawTable& table, const DrawTable& next);

/// The metric of this name; null if the table has none.
[[nodiscard]] const DrawColumn* find_metric(const DrawTable& table, const std::string& name);

/// A requirement of the user's own.
struct OwnColumn {
  std::string name;
  std::string
      path;  ///< of its columns: "own_requirements.NAME", of a hazard map "score.own_requirements.NAME"
  const DrawColumn* passes;
};
[[nodiscard]] std::vector<OwnColumn> own_columns(const DrawTable& table);

/// 1: passed, 0: failed, -1: not judged, because a requirement is not and none is missed.
[[nodiscard]] constexpr std::int8_t pass_flag(std::optional<bool> pass) {
  return !pass ? std::int8_t{-1} : *pass ? std::int8_t{1} : std::int8_t{0};
}

/// pass_flag() of all six requirements of each draw: without the user's own.
[[nodiscard]] std::vector<std::int8_t> six_passed(const DrawTable& table);

/// The number of draws in which a requirement is judged.
[[nodiscard]] std::int64_t judged_draws(const DrawTable& table, const std::string& requirement);

/// The metric "requirements.NAME.pass"; throws std::out_of_range if the table has none.
[[nodiscard]] const DrawColumn& pass_column(const DrawTable& table, const std::string& requirement);

}  // namespace landfall
