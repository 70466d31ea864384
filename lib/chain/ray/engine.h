// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

#include "base/geometry/frames.h"

namespace landfall {

/// A half-line from `origin` along the unit vector `direction`.
struct Ray {
  Point<DemFrame> origin;
  Direction<DemFrame> direction;
};

/// Finds where rays first meet the terrain. Every engine gives the same answer: |range - exact intersection
/// with the stored surface| <= 1e-6 m, without leaks: a ray through a shared edge or vertex hits. Surfaces
/// are two-sided. Holes (NaN) and points outside the terrain are misses. An engine is immutable once built:
/// any number of threads may use it.
class RayEngine {
 public:
  virtual ~RayEngine() = default;

  /// ranges[i] = distance along rays[i] to its first hit, metres, >= 0; NaN where the ray misses. Both spans
  /// have the same size. Engines are tuned for calls that pass the rays of one pulse in pixel order; any set
  /// of rays is allowed.
  virtual void first_hits(std::span<const Ray> rays, std::span<double> ranges) const = 0;
};

}  // namespace landfall
