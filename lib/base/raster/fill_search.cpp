// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D435
#include "base/raster/fill_search.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text/joined.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

/// Raw numbers that stand for "no data" in files of many producers.
constexpr std::array kFills = {-32768.0,      -32767.0,      32767.0,      65535.0,  -9999.0,
                               9999.0,        -99999.0,      99999.0,      -999.0,   1e6,
                               -2147483648.0, -2147483647.0, 2147483647.0, -999999.0};
constexpr double kAbsurd = 1e12;  ///< no elevation; -3.4e38 and the default fills of netCDF lie beyond
constexpr std::size_t kMaxAside = 2;
constexpr std::size_t kMinDistinct = 16;

std::string raw_numbers(const std::vector<Fill>& fills, const char* separator) {
  return joined(fills, separator, [](const Fill& fill) { return number_text(fill.raw); });
}

}  // namespace

std::int64_t count_of(const std::vector<Fill>& fills) {
  std::int64_t count = 0;
  for (const Fill& fill : fills) count += fill.count;
  return count;
}

std::string nodata_text(const std::vector<Fill>& fills) { return raw_numbers(fills, ","); }

std::string suspicion_text(const std::vector<Fill>& fills) {
  return raw_numbers(fills, " or ") + (fills.size() == 1 ? ", which looks like an undeclared fill value"
                                                         : ", which look like undeclared fill values");
}

void FillSearch::Lowest::count(double value) {
  if (!(value <= limit_)) return;
  if (last_ < values_.size() && values_[last_].value == value) {
    ++values_[last_].count;
    return;
  }
  const auto place = std::lower_bound(values_.begin(), values_.end(), value,
                                      [](const Counted& entry, double v) { return entry.value > v; });
  last_ = static_cast<std::size_t>(place - values_.begin());
  if (place != values_.end() && place->value == value) {
    ++place->count;
    return;
  }
  values_.insert(place, {value, 1});
  if (values_.size() > 2 * kKept) {
    values_.erase(values_.begin(), values_.end() - kKept);
    last_ = values_.size();
  }
  if (values_.size() >= kKept) limit_ = values_[values_.size() - kKept].value;
}

std::vector<FillSearch::Counted> FillSearch::Lowest::values() const {
  const auto kept = static_cast<std::ptrdiff_t>(std::min(values_.size(), kKept));
  return {values_.rbegin(), values_.rbegin() + kept};
}

void FillSearch::add_end(double value) {
  if (std::abs(value - stored_.offset) >= kAbsurd * std::abs(stored_.scale)) {
    absurd_.count(value);
  } else {
    lowest_.count(value);
    highest_.count(-value);
  }
}

/// The distinct values at both ends, ascending; all of them if they are few.
std::vector<FillSearch::Counted> FillSearch::ends() const {
  std::vector<Counted> values = lowest_.values();
  std::vector<Counted> high = highest_.values();
  for (auto entry = high.rbegin(); entry != high.rend(); ++entry)
    if (values.empty() || -entry->value > values.back().value)
      values.push_back({-entry->value, entry->count});
  return values;
}

/// With the raw number that gives the value exactly, where rounding hides it.
Fill FillSearch::fill(const Counted& counted) const {
  const auto value = [&](double raw) { return stored_.scale * raw + stored_.offset; };
  double raw = (counted.value - stored_.offset) / stored_.scale;
  for (const double candidate : {std::round(raw), static_cast<double>(static_cast<float>(raw))})
    if (value(candidate) == counted.value) raw = candidate;
  return {raw, counted.value, counted.count};
}

FillSearch::Result FillSearch::result() const {
  Result result;
  result.total = total_;
  for (const Counted& absurd : absurd_.values()) result.fills.push_back(fill(absurd));
  std::vector<Counted> values = ends();
  take_known(values, result);
  take_apart(values, result);
  if (!values.empty()) result.rest = {values.front().value, values.back().value};
  return result;
}

bool FillSearch::is_known(const Counted& entry) const {
  return std::ranges::any_of(kFills,
                             [&](double raw) { return stored_.scale * raw + stored_.offset == entry.value; });
}

/// Moves the known numbers that are isolated from the rest to the result.
void FillSearch::take_known(std::vector<Counted>& values, Result& result) const {
  Range rest;
  for (const Counted& entry : values) {
    if (is_known(entry)) continue;
    rest.low = std::min(rest.low, entry.value);
    rest.high = entry.value;
  }
  const double step = stored_.is_integer ? 2 * std::abs(stored_.scale) : 0;  // a step of the numbers
  const auto is_fill = [&](const Counted& entry) {
    if (!is_known(entry)) return false;
    if (rest.empty()) return true;
    const double distance = std::max(rest.low - entry.value, entry.value - rest.high);
    const double range = rest.high - rest.low;
    if (distance <= step) return false;
    return distance > 0.1 * range || (distance > 0.001 * range && 100 * entry.count > total_);
  };
  for (const Counted& entry : values)
    if (is_fill(entry)) result.fills.push_back(fill(entry));
  std::erase_if(values, is_fill);
}

/// Moves the repeated values that are farther from the rest than its range to the result, and known numbers
/// beside them, with the others beyond them.
void FillSearch::take_apart(std::vector<Counted>& values, Result& result) const {
  const auto are_apart = [&](std::size_t low, std::size_t high) {
    const std::size_t end = values.size() - high;
    const double range = values[end - 1].value - values[low].value;
    return (low == 0 || values[low].value - values[low - 1].value > range) &&
           (high == 0 || values[end].value - values[end - 1].value > range);
  };
  const auto is_repeated = [](const Counted& entry) { return entry.count > 1; };
  for (std::size_t aside = 2 * kMaxAside; aside > 0; --aside)
    for (std::size_t low = aside > kMaxAside ? aside - kMaxAside : 0; low <= std::min(aside, kMaxAside);
         ++low) {
      const std::size_t high = aside - low;
      if (values.size() < aside + kMinDistinct || !are_apart(low, high)) continue;
      std::vector<Counted> outside(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(low));
      outside.insert(outside.end(), values.end() - static_cast<std::ptrdiff_t>(high), values.end());
      if (std::ranges::none_of(outside, is_repeated)) continue;
      for (const Counted& entry : outside)
        if (is_repeated(entry) || is_known(entry)) result.fills.push_back(fill(entry));
      values.erase(values.end() - static_cast<std::ptrdiff_t>(high), values.end());
      values.erase(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(low));
      return;
    }
}

}  // namespace landfall
