// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/flash.h"

namespace landfall {

void Flash::steer(const ScannerState&, std::span<const Direction<LidarFrame>> pixels,
                  std::span<Beam> beams) const {
  for (std::size_t i = 0; i < pixels.size(); ++i) beams[i] = Beam{.direction = pixels[i]};
}

}  // namespace landfall
