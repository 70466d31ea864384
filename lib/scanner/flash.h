// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "scanner/scanner.h"

namespace landfall {

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
