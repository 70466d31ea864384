// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

namespace landfall {

/// Called by long-running work with the fraction done: never decreasing, in [0, 1], the last call is 1. It
/// may be called from any thread, one call at a time. An empty function reports no progress.
using ProgressCallback = std::function<void(double fraction)>;

inline void report(const ProgressCallback& progress, double fraction) {
  if (progress) progress(fraction);
}

/// Runs a named part of the work and shows its progress.
using PhaseRunner =
    std::function<void(const std::string& name, const std::function<void(const ProgressCallback&)>& part)>;

}  // namespace landfall
