// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "base/numerics/random.h"
#include "chain/lidar/scanner/risley_steering.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// Both prisms turn evenly: theta_i = 2 pi rate_i t + phase_i, t since the first pulse.
struct RisleyRotation {
  std::array<double, 2> rates_hz{100, -61.8};  ///< right-handed about +z_L; in [-1e6, 1e6]
  std::array<double, 2> phases_rad{};          ///< finite
};

struct RisleyParameters {
  RisleyOptics optics{};
  /// A rotation, which ignores the aim; or a branch: the boresight follows the aim.
  std::variant<RisleyRotation, RisleyBranch> drive{};
  /// One sigma of each prism's angle about the commanded one, which the lander assumes; >= 0.
  double encoder_sigma_rad = 0;
  RandomSeed seed = {};
};

/// Two rotating wedge prisms. Every ray is traced through their four faces.
///
/// All rays start at the origin of L, the focal point, where the axis meets the first face. At a face with
/// unit normal N along the beam, from index n to n', a ray d continues as
///   d' = mu d + (sqrt(1 - mu^2 (1 - c^2)) - mu c) N,  mu = n/n', c = d.N,
/// and is lost where the radicand is negative (total reflection) or where the ray does not meet the face (c
/// <= 0). `exit` is where the ray leaves the last face, the thicknesses and the gap ahead of the focal point;
/// ranges count from there. The faces are unbounded planes.
///
/// angle_1 and angle_2 are theta_1 and theta_2 of the prisms; the commanded angles lie in [-pi, pi].
class Risley : public Scanner {
 public:
  /// Throws UsageError, naming the key and the bound, for a parameter out of range.
  explicit Risley(const RisleyParameters& parameters);

  /// When steered by an aim, throws FormatError, naming pulse and angle, for an aim outside the reach.
  /// Without an aim both commanded angles are 0.
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  [[nodiscard]] bool is_known() const override { return encoder_sigma_rad_ == 0; }
  /// The commanded angles.
  [[nodiscard]] ScannerState estimated_state(const PulseContext& pulse,
                                             const ScannerState& truth) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  /// A plane through (0, 0, vertex_m) between two media.
  struct Face {
    double wedge_rad;  ///< 0 for the plane faces
    double vertex_m;
    double index_ratio;  ///< before the face / after it
  };

  [[nodiscard]] RisleyAngles commanded(const PulseContext& pulse) const;
  [[nodiscard]] RisleyAngles follow(const PulseContext& pulse, RisleyBranch branch) const;

  std::variant<RisleyRotation, RisleyBranch> drive_;
  double encoder_sigma_rad_;
  RandomField encoder_;
  RisleySteering steering_;
  std::array<Face, 4> faces_;
};

}  // namespace landfall
