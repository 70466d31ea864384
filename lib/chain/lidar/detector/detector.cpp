// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/detector/detector.h"

#include <string>
#include <utility>

#include "base/core/error.h"

namespace landfall {
namespace {

void check_count(const char* what, std::size_t count, std::size_t expected) {
  if (count == expected) return;
  throw UsageError("detector: " + std::to_string(count) + " " + what + " directions where its size needs " +
                   std::to_string(expected));
}

}  // namespace

Detector::Detector(const DetectorSize& size, std::vector<Direction<LidarFrame>> pixels,
                   std::vector<Direction<LidarFrame>> samples, const RangeEstimator& estimator)
    : size_(size),
      samples_per_pixel_(static_cast<std::size_t>(size.subpixels) * static_cast<std::size_t>(size.subpixels)),
      pixels_(std::move(pixels)),
      samples_(std::move(samples)),
      estimator_(estimator) {
  check_count("pixel", pixels_.size(),
              static_cast<std::size_t>(size.rows) * static_cast<std::size_t>(size.columns));
  check_count("sample", samples_.size(), samples_per_pixel_ == 1 ? 0 : samples_per_pixel_ * pixels_.size());
}

std::size_t Detector::index(PixelIndex pixel) const {
  return static_cast<std::size_t>(pixel.row) * static_cast<std::size_t>(size_.columns) +
         static_cast<std::size_t>(pixel.col);
}

}  // namespace landfall
