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
  hold,  ///< the last aim is held
  wrap,  ///< the table starts again
};

struct TablePatternParameters {
  std::vector<AimSample> samples;
  AtTableEnd at_end = AtTableEnd::stop;
  bool compensated = true;
};

/// A tabulated aim, linear in time between rows. Pulse times are rounded, so a time up to 1 ns past the last
/// row counts as the last row.
class TablePattern : public Pattern {
 public:
  /// Times must begin at 0 and increase strictly, all numbers must be finite, at least 2 rows are needed, and
  /// a table that wraps must end within 1 mm of its first aim. Throws FormatError otherwise; the message
  /// begins with `name` and names the row counted from 1.
  explicit TablePattern(TablePatternParameters parameters, const std::string& name = "pattern table");

  [[nodiscard]] std::optional<Point<DemFrame>> ground_aim(const PulseTime& pulse) const override;

 private:
  TablePatternParameters parameters_;
};

}  // namespace landfall
