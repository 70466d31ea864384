// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D305
#include "chain/draws/sprt.h"

#include <cassert>

#include "base/numerics/portable_math.h"
#include "base/text/parameter_check.h"

namespace landfall {
namespace {

constexpr double kLogTolerance = 1e-9;

}  // namespace

void check(const SprtParameters& parameters) {
  const auto require_inside = [](const char* key, double value, double maximum, const char* bound) {
    require(value > 0 && value < maximum, {"", key}, value, bound);
  };
  require_inside("p0", parameters.p0, 1, "in (0, 1)");
  require_inside("p1", parameters.p1, parameters.p0, "in (0, p0)");
  require_inside("alpha", parameters.alpha, 0.5, "in (0, 0.5)");
  require_inside("beta", parameters.beta, 0.5, "in (0, 0.5)");
}

Sprt::Sprt(const SprtParameters& parameters)
    : pass_(portable::log(parameters.p1 / parameters.p0)),
      fail_(portable::log((1 - parameters.p1) / (1 - parameters.p0))),
      accept_(portable::log(parameters.beta / (1 - parameters.alpha)) + kLogTolerance),
      reject_(portable::log((1 - parameters.beta) / parameters.alpha) - kLogTolerance) {
  check(parameters);
}

void Sprt::add(bool passed) {
  assert(state_ == SprtState::running);
  rate_.k += passed ? 1 : 0;
  rate_.n += 1;
  const double ratio = static_cast<double>(rate_.k) * pass_ + static_cast<double>(rate_.n - rate_.k) * fail_;
  if (ratio <= accept_) state_ = SprtState::accepted;
  if (ratio >= reject_) state_ = SprtState::rejected;
}

}  // namespace landfall
