// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <ostream>
#include <string>

#include "chain/evaluation/metrics.h"

namespace landfall {

/// A verdict as a test expects it.
struct Judged {
  std::optional<double> value;
  double limit = 0;
  std::optional<bool> pass = std::nullopt;
  std::optional<std::string> reason = std::nullopt;
};

inline bool operator==(const RequirementVerdict& verdict, const Judged& expected) {
  return verdict.value == expected.value && verdict.requirement.limit == expected.limit &&
         verdict.pass == expected.pass && verdict.reason == expected.reason;
}

inline void PrintTo(const Judged& expected, std::ostream* out) {
  *out << expected.value.value_or(-1) << " against " << expected.limit << ", "
       << expected.reason.value_or("");
}

inline void set(RequirementVerdict& verdict, const Judged& judged) {
  verdict.value = judged.value;
  verdict.requirement.limit = judged.limit;
  verdict.pass = judged.pass;
  verdict.reason = judged.reason;
}

}  // namespace landfall
