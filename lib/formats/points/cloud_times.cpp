// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D439
#include "formats/points/cloud_times.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/core/error.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr double kLargestSeconds = 1e12;
constexpr double kDay_s = 86400;

struct UnitName {
  const char* name;
  double per_second;
};
/// In the order of TimeUnit.
constexpr std::array<UnitName, 4> kTimeUnits = {{{"s", 1}, {"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}};

/// A time with its base; whole ones with all digits.
std::string time_text(double t, std::int64_t base) {
  const bool is_whole = std::abs(t) < 0x1p53 && t == std::floor(t);
  return is_whole ? std::to_string(static_cast<std::int64_t>(t) + base)
                  : number_text(t + static_cast<double>(base));
}

}  // namespace

TimeUnit time_unit(const std::string& text) {
  for (std::size_t i = 0; i < kTimeUnits.size(); ++i)
    if (text == kTimeUnits[i].name) return static_cast<TimeUnit>(i);
  throw UsageError("--time-unit: '" + text + "' is not one of s, ms, us, ns");
}

double per_second(TimeUnit unit) { return kTimeUnits[static_cast<std::size_t>(unit)].per_second; }

const char* name_of(TimeUnit unit) { return kTimeUnits[static_cast<std::size_t>(unit)].name; }

TimeScale time_scale(const std::string& name, const CloudInfo& info, std::optional<TimeUnit> unit,
                     const TimeExtent& times) {
  const auto base = static_cast<double>(info.time_base);
  const double largest = std::max(std::abs(times.first + base), std::abs(times.last + base));
  const bool is_known = !info.clock.empty();
  if (!is_known && !unit && largest > kLargestSeconds)
    throw FormatError(name + ": a time of " + time_text(times.last, info.time_base) +
                      " is not in seconds: give its unit with --time-unit ms, us or ns (s keeps it)");
  const UnitName& from = kTimeUnits[static_cast<std::size_t>(unit.value_or(TimeUnit::s))];
  TimeScale scale{.origin = -base, .per_second = from.per_second, .clock = info.clock};
  if (from.per_second > 1 && largest > kLargestSeconds) {
    scale.origin = times.first;
    scale.clock = "seconds since " + time_text(times.first, info.time_base) + " " + from.name +
                  " on the clock of the source";
  }
  const double span_s = (times.last - times.first) / from.per_second;
  if (!is_known && span_s > kDay_s)
    scale.warning = "its times span " + short_number(span_s) + " s, which is more than a day: " +
                    (unit ? "is their unit " + std::string(from.name) + "?"
                          : "if they are not in seconds, give their unit with --time-unit ms, us or ns");
  return scale;
}

}  // namespace landfall
