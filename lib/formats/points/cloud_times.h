// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include "formats/points/cloud_reader.h"

namespace landfall {

enum class TimeUnit { s, ms, us, ns };

/// The unit of "s", "ms", "us" or "ns". Throws UsageError for another text.
[[nodiscard]] TimeUnit time_unit(const std::string& text);
[[nodiscard]] const char* name_of(TimeUnit unit);
[[nodiscard]] double per_second(TimeUnit unit);

/// The first and the last t of a file's points, in its unit, without CloudInfo::time_base.
struct TimeExtent {
  double first, last;
};

/// Converts times of a file to seconds.
struct TimeScale {
  double origin = 0;
  double per_second = 1;
  std::string clock;      ///< what the seconds count; empty: not known
  std::string warning{};  ///< without the file's name; empty: none

  [[nodiscard]] double seconds(double t) const { return (t - origin) / per_second; }
};

/// The scale of a file's times. Times beyond 1e12 in another unit than seconds count from the first one,
/// because a double of their seconds since 1970 has no nanoseconds; others keep their zero. Warns of points
/// that span more than a day, unless the file says what its times count, as LAS does.
///
/// Throws FormatError, naming the file, for times beyond 1e12 without a unit: as seconds they are 30,000
/// years.
[[nodiscard]] TimeScale time_scale(const std::string& name, const CloudInfo& info,
                                   std::optional<TimeUnit> unit, const TimeExtent& times);

}  // namespace landfall
