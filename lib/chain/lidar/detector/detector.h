// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "base/geometry/frames.h"
#include "chain/lidar/detector/range_estimator.h"

namespace landfall {

/// A pixel by row and column. Row 0 is the top of the image, column 0 its left side: with the nominal mount
/// they look towards +y_D and -x_D.
struct PixelIndex {
  int row = 0;
  int col = 0;
  friend bool operator==(const PixelIndex&, const PixelIndex&) = default;
};

struct DetectorSize {
  int rows = 1;
  int columns = 1;
  /// Each pixel is sampled by subpixels x subpixels rays.
  int subpixels = 1;
  friend bool operator==(const DetectorSize&, const DetectorSize&) = default;
};

/// The focal plane: where each pixel looks, in L, before any steering, and the range that it reports from the
/// ranges of its sub-pixels. The simulation knows nothing else of a detector; how the directions were
/// computed (perspective.h) does not matter.
class Detector {
 public:
  /// `pixels`: rows x columns directions, row-major. `samples`: subpixels^2 directions per pixel, contiguous
  /// per pixel, row-major in the pixel; empty where subpixels = 1, where the pixel's own direction is the
  /// sample. Throws UsageError where a count does not fit `size`.
  Detector(const DetectorSize& size, std::vector<Direction<LidarFrame>> pixels,
           std::vector<Direction<LidarFrame>> samples, const RangeEstimator& estimator = {});

  [[nodiscard]] const DetectorSize& size() const { return size_; }
  [[nodiscard]] std::size_t pixel_count() const { return pixels_.size(); }
  [[nodiscard]] std::size_t samples_per_pixel() const { return samples_per_pixel_; }
  /// Row-major position; the pixel must lie on the detector.
  [[nodiscard]] std::size_t index(PixelIndex pixel) const;

  [[nodiscard]] std::span<const Direction<LidarFrame>> pixels() const { return pixels_; }
  [[nodiscard]] std::span<const Direction<LidarFrame>> samples() const {
    return samples_.empty() ? pixels_ : samples_;
  }
  [[nodiscard]] const RangeEstimator& estimator() const { return estimator_; }

 private:
  DetectorSize size_;
  std::size_t samples_per_pixel_;
  std::vector<Direction<LidarFrame>> pixels_;
  std::vector<Direction<LidarFrame>> samples_;
  RangeEstimator estimator_;
};

}  // namespace landfall
