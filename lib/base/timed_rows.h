// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "base/error.h"

namespace landfall {

/// Throws FormatError "name: row 3: what"; rows are counted from 1.
[[noreturn]] inline void refuse_row(const std::string& name, std::size_t index, const std::string& what) {
  throw FormatError(name + ": row " + std::to_string(index + 1) + ": " + what);
}

/// Checks a table over time: at least 2 rows, t_s finite and strictly increasing by finite steps, `is_finite`
/// true for each row. Otherwise throws FormatError, which begins with `name`, for the first invalid row.
template <class Row, class IsFinite>
void require_timed_rows(std::span<const Row> rows, const std::string& name, const IsFinite& is_finite) {
  if (rows.size() < 2)
    throw FormatError(name + ": " + std::to_string(rows.size()) + " rows, at least 2 are needed");
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!std::isfinite(rows[i].t_s) || !is_finite(rows[i])) refuse_row(name, i, "a value is not finite");
    if (i > 0 && !(rows[i].t_s > rows[i - 1].t_s))
      refuse_row(name, i, "t_s does not exceed that of the row before");
    if (i > 0 && !std::isfinite(rows[i].t_s - rows[i - 1].t_s))
      refuse_row(name, i, "the step of t_s from the row before is not a finite number");
  }
}

}  // namespace landfall
