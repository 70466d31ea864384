// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "base/number_table.h"
#include "scanner/pattern.h"

namespace landfall {

/// One row of an aim table.
struct AimSample {
  double t_s = 0;  ///< since the first pulse
  double x_m = 0;
  double y_m = 0;
};

/// The columns of an aim table: t_s, x_m, y_m.
[[nodiscard]] const TableColumns& aim_columns();
[[nodiscard]] std::vector<AimSample> aim_samples(const NumberTable& table);

enum class AtTableEnd {
  stop,  ///< no more pulses are fired
  hold,  ///< the last aim stays
  wrap,  ///< the table begins anew
};

struct TablePatternParameters {
  std::vector<AimSample> samples;
  AtTableEnd at_end = AtTableEnd::stop;
  bool compensated = true;
};

/// A tabulated aim, linear in time between rows. A time that lies up to 1 ns past the last row counts as its
/// end: pulse times are rounded.
class TablePattern : public Pattern {
 public:
  /// Times begin at 0 and increase strictly, everything is finite, there are at least 2 rows, and a table
  /// that wraps ends within 1 mm of where it begins. Throws FormatError, begun by `name` and naming the row
  /// counted from 1, otherwise.
  explicit TablePattern(TablePatternParameters parameters, const std::string& name = "pattern table");

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;
  [[nodiscard]] std::optional<std::int64_t> pulse_limit() const override { return std::nullopt; }
  [[nodiscard]] bool compensated() const override { return parameters_.compensated; }

 private:
  TablePatternParameters parameters_;
};

}  // namespace landfall
