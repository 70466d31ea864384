// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>

#include "geometry/frames.h"
#include "scanner/pulse_time.h"

namespace landfall {

/// What a scanner is told of a pulse.
struct PulseContext {
  PulseTime time{};
  /// Where the pattern wants the boresight; none where there is no pattern, or none for this pulse.
  std::optional<Direction<LidarFrame>> aim{};
};

/// The mechanism at one pulse.
struct ScannerState {
  double angle_1_rad = 0;  ///< what the two angles are, each scanner says
  double angle_2_rad = 0;
  /// A mirror's normal: exact, where the angles are rounded. Scanners without a mirror leave it alone.
  Direction<LidarFrame> mirror_normal{};
  bool blanked = false;  ///< the laser does not fire
};

/// One pixel's ray behind the scanner, in L: points b + r n of Eq. 1.
struct Beam {
  Direction<LidarFrame> direction{};  ///< n
  Point<LidarFrame> exit{};           ///< b
  bool lost = false;                  ///< total reflection: it never leaves; the rest has no meaning
};

/// Steers the rays of all pixels: a pure function of time, without stepping state. Any thread may ask for any
/// pulse in any order.
class Scanner {
 public:
  virtual ~Scanner() = default;

  /// Throws FormatError, naming the pulse, where the mechanism cannot follow the aim.
  [[nodiscard]] virtual ScannerState state(const PulseContext& pulse) const = 0;
  /// beams[i] is the ray of pixels[i]; both spans have one size. `pixels` are directions in L as they leave
  /// the resting scanner, `state` comes from state().
  virtual void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                     std::span<Beam> beams) const = 0;
};

}  // namespace landfall
