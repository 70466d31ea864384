// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <optional>
#include <span>

#include "base/geometry/frames.h"
#include "chain/lidar/scanner/pattern.h"

namespace landfall {

/// The aims around the last jump, from which a scanner with inertia finds the motion that it has to make.
/// Without a second pulse in its line or step an aim does not move: both are the same.
struct JumpAims {
  Direction<LidarFrame> before_last{};  ///< the pulse before the last one before the jump
  Direction<LidarFrame> last{};         ///< the last pulse before the jump
  Direction<LidarFrame> first{};        ///< the first pulse after the jump
  Direction<LidarFrame> second{};       ///< the pulse after the first one
  double interval_s = 0;                ///< from pulse to pulse
};

/// The input of a scanner for a pulse. All aims are seen from the nominal pose of this pulse.
struct PulseContext {
  PulseTime time{};
  /// The direction in which the pattern aims the boresight; empty without a pattern or an aim.
  std::optional<Direction<LidarFrame>> aim{};
  /// Time since the last jump of the aim, to a new line or step, and the aim before it; infinite and empty
  /// without a jump. Only for scanners that need it.
  double since_jump_s = std::numeric_limits<double>::infinity();
  std::optional<Direction<LidarFrame>> aim_before_jump{};
  /// Only for scanners that need it; empty without a jump.
  std::optional<JumpAims> jump_aims{};
  /// The aim when the echo from the aimed point returns, 2 r/c after the pulse; the aim moves linearly
  /// between two pulses. Only for scanners that need it.
  std::optional<Direction<LidarFrame>> aim_at_echo{};
};

/// The parts of a PulseContext that are expensive and that not every mechanism needs.
struct ContextNeeds {
  bool jumps = false;   ///< since_jump_s, aim_before_jump
  bool echo = false;    ///< aim_at_echo
  bool motion = false;  ///< jump_aims; needs `jumps` too
};

/// The state of the mechanism at one pulse.
struct ScannerState {
  double angle_1_rad = 0;  ///< each scanner defines its two angles
  double angle_2_rad = 0;
  /// The normal of a mirror, exact, unlike the rounded angles. Scanners without a mirror leave it unset.
  Direction<LidarFrame> mirror_normal{};
  bool blanked = false;  ///< the laser does not fire
};

/// The ray of one pixel after the scanner, in L: points b + r n of Eq. 1.
struct Beam {
  Direction<LidarFrame> direction{};  ///< n
  Point<LidarFrame> exit{};           ///< b
  bool lost = false;  ///< never leaves (total reflection, back of a mirror); the rest is undefined
};

/// beams[i] leaves the focal point along the rotated direction of pixels[i]: d' = R d, b = 0.
inline void rotate_all(const Eigen::Matrix3d& rotation, std::span<const Direction<LidarFrame>> pixels,
                       std::span<Beam> beams) {
  for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = {rotation * pixels[i].v}};
}

/// Steers the rays of all pixels: a pure function of time, without stepping state. Any thread may call it for
/// any pulse in any order.
class Scanner {
 public:
  virtual ~Scanner() = default;

  /// Throws FormatError, naming the pulse, where the mechanism cannot follow the aim.
  [[nodiscard]] virtual ScannerState state(const PulseContext& pulse) const = 0;
  [[nodiscard]] virtual ContextNeeds needs() const { return {}; }

  /// False if the estimated state may differ from the true one, for example by encoder noise.
  [[nodiscard]] virtual bool is_known() const { return true; }
  /// The state from which the lander computes its points; `truth` is the result of state().
  [[nodiscard]] virtual ScannerState estimated_state(const PulseContext&, const ScannerState& truth) const {
    return truth;
  }
  /// beams[i] is the ray of pixels[i]; both spans have the same size. `pixels` are directions in L as they
  /// leave the resting scanner, `state` comes from state().
  virtual void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
                     std::span<Beam> beams) const = 0;
};

/// No steering: every pulse looks where the pixels look and ignores the aim. Both angles are 0.
class Flash : public Scanner {
 public:
  [[nodiscard]] ScannerState state(const PulseContext&) const override { return {}; }
  void steer(const ScannerState&, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override {
    for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = pixels[i]};
  }
};

}  // namespace landfall
