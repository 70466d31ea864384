// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "geometry/frames.h"
#include "scanner/pulse_time.h"

namespace landfall {

/// What a scanner is told of a pulse. All aims are seen from the nominal pose of this pulse.
struct PulseContext {
  PulseTime time{};
  /// Where the pattern wants the boresight; none where there is no pattern, or none for this pulse.
  std::optional<Direction<LidarFrame>> aim{};
  /// Time since the aim last jumped, to a new line or step, and where it was before; infinite and none where
  /// it has not jumped. Only for scanners that ask for it.
  double since_jump_s = std::numeric_limits<double>::infinity();
  std::optional<Direction<LidarFrame>> aim_before_jump{};
  /// The aim when the echo from the aimed point comes back, 2 r/c after the pulse; between two pulses the aim
  /// moves evenly. Only for scanners that ask for it.
  std::optional<Direction<LidarFrame>> aim_at_echo{};
};

/// The parts of a PulseContext that cost something and that not every mechanism looks at.
struct ContextNeeds {
  bool jumps = false;  ///< since_jump_s, aim_before_jump
  bool echo = false;   ///< aim_at_echo
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

/// beams[i] leaves the focal point along the turned direction of pixels[i]: d' = R d, b = 0.
inline void turn_all(const Eigen::Matrix3d& turn, std::span<const Direction<LidarFrame>> pixels,
                     std::span<Beam> beams) {
  for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = {turn * pixels[i].v}};
}

/// Steers the rays of all pixels: a pure function of time, without stepping state. Any thread may ask for any
/// pulse in any order.
class Scanner {
 public:
  virtual ~Scanner() = default;

  /// Throws FormatError, naming the pulse, where the mechanism cannot follow the aim.
  [[nodiscard]] virtual ScannerState state(const PulseContext& pulse) const = 0;
  [[nodiscard]] virtual ContextNeeds needs() const { return {}; }

  /// False where the lander's idea of the mechanism may differ from what it is, by encoder noise say.
  [[nodiscard]] virtual bool is_known() const { return true; }
  /// The state that the lander believes, from which it computes its points; `truth` is state()'s answer.
  [[nodiscard]] virtual ScannerState believed_state(const PulseContext&, const ScannerState& truth) const {
    return truth;
  }
  /// beams[i] is the ray of pixels[i]; both spans have one size. `pixels` are directions in L as they leave
  /// the resting scanner, `state` comes from state().
  virtual void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                     std::span<Beam> beams) const = 0;
};

}  // namespace landfall
