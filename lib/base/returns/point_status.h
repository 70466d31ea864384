// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace landfall {

/// The outcome of one pixel at one pulse. The values are those of the scan file.
enum class PointStatus : std::int8_t {
  returned = 0,
  miss = 1,
  dropout = 2,
  dead = 3,
  blanked = 4,
  lost_in_optics = 5,
  false_return = 6,
  undetected = 7,
};

/// The names of one status.
struct PointStatusInfo {
  PointStatus status;
  const char* meaning;     ///< in the scan file (CF: flag_meanings)
  const char* count_name;  ///< number of such rows: attribute of /points, key of summaries; empty: not shown
  const char* cause;       ///< after a number, why there are no returns: "12 misses"; empty for returns

  /// A scan without a receiver has no undetected pixels, and does not count them.
  [[nodiscard]] constexpr bool is_counted(bool has_receiver) const {
    return *count_name != '\0' && (has_receiver || status != PointStatus::undetected);
  }
};

/// Every status once, in the order of its value. Scan files hold values and meanings: add new ones at the end
/// and change none.
inline constexpr std::array kPointStatuses = {
    PointStatusInfo{PointStatus::returned, "return", "return_count", ""},
    PointStatusInfo{PointStatus::miss, "miss", "miss_count", " misses"},
    PointStatusInfo{PointStatus::dropout, "dropout", "dropout_count", " dropouts"},
    PointStatusInfo{PointStatus::dead, "dead", "dead_count", " of dead pixels"},
    PointStatusInfo{PointStatus::blanked, "blanked", "", " of blanked pulses"},
    PointStatusInfo{PointStatus::lost_in_optics, "total_reflection", "",
                    " lost in the scanner (total reflection)"},
    PointStatusInfo{PointStatus::false_return, "false_return", "false_return_count", ""},
    PointStatusInfo{PointStatus::undetected, "undetected", "undetected_count", " too weak to be detected"}};

inline constexpr std::size_t kPointStatusCount = kPointStatuses.size();

/// True for a status that has a range: a return or a false return.
[[nodiscard]] constexpr bool is_return(PointStatus status) {
  return status == PointStatus::returned || status == PointStatus::false_return;
}

}  // namespace landfall
