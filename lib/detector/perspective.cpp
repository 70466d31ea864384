// SPDX-License-Identifier: GPL-3.0-or-later
#include "detector/perspective.h"

#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

#include "base/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxPixelsPerAxis = 4096;
constexpr int kMaxSubpixels = 64;
constexpr std::int64_t kMaxSamples = std::int64_t{1} << 26;

/// Tangent units, per image axis.
struct Pitch {
  double x;
  double y;
};

double pitch_of(double ifov_rad, const char* key) {
  require_positive({"detector", key}, ifov_rad);
  return ifov_rad;
}

double pitch_of(double fov_rad, int pixels, const char* key) {
  require(fov_rad > 0 && fov_rad < std::numbers::pi, {"detector", key}, fov_rad, "between 0 and pi");
  return 2 * std::tan(fov_rad / 2) / pixels;
}

Pitch pitch_of(const PerspectiveParameters& p) {
  if (const auto* ifov = std::get_if<PixelFieldOfView>(&p.field_of_view))
    return {pitch_of(ifov->x_rad, "ifov_rad[0]"), pitch_of(ifov->y_rad, "ifov_rad[1]")};
  const auto& fov = std::get<FullFieldOfView>(p.field_of_view);
  return {pitch_of(fov.x_rad, p.columns, "fov_rad[0]"), pitch_of(fov.y_rad, p.rows, "fov_rad[1]")};
}

void check(const PerspectiveParameters& p) {
  require(p.rows >= 1 && p.rows <= kMaxPixelsPerAxis, {"detector", "rows"}, p.rows, "in 1..4096");
  require(p.columns >= 1 && p.columns <= kMaxPixelsPerAxis, {"detector", "columns"}, p.columns, "in 1..4096");
  require(p.subpixels >= 1 && p.subpixels <= kMaxSubpixels, {"detector", "subpixels"}, p.subpixels,
          "in 1..64");
  const std::int64_t samples = std::int64_t{p.rows} * p.columns * p.subpixels * p.subpixels;
  require(samples <= kMaxSamples, {"detector", "rows x columns x subpixels^2"}, static_cast<double>(samples),
          "at most 67108864");
  require_finite({"detector", "roll_rad"}, p.roll_rad);
}

/// Offset of item `i` of `count` from their middle, in items.
double from_middle(int i, int count) { return i - (count - 1) / 2.0; }

/// Turns a place on the image plane, (right, down) in tangent units, into a direction.
class ImagePlane {
 public:
  ImagePlane(const Pitch& pitch, double roll_rad)
      : pitch_(pitch), cos_(std::cos(roll_rad)), sin_(std::sin(roll_rad)) {}

  /// `right` and `down` in pixels from the boresight.
  [[nodiscard]] Direction<LidarFrame> look(double right, double down) const {
    const double x = right * pitch_.x;
    const double y = down * pitch_.y;
    return Direction<LidarFrame>::of({{x * cos_ + y * sin_, y * cos_ - x * sin_, 1}});
  }

 private:
  Pitch pitch_;
  double cos_;
  double sin_;
};

}  // namespace

Detector perspective_detector(const PerspectiveParameters& parameters) {
  check(parameters);
  const ImagePlane plane(pitch_of(parameters), parameters.roll_rad);
  const int m = parameters.subpixels;
  std::vector<Direction<LidarFrame>> pixels;
  std::vector<Direction<LidarFrame>> samples;
  for (int row = 0; row < parameters.rows; ++row) {
    const double down = from_middle(row, parameters.rows);
    for (int col = 0; col < parameters.columns; ++col) {
      const double right = from_middle(col, parameters.columns);
      pixels.push_back(plane.look(right, down));
      for (int i = 0; m > 1 && i < m * m; ++i)
        samples.push_back(plane.look(right + from_middle(i % m, m) / m, down + from_middle(i / m, m) / m));
    }
  }
  return Detector({parameters.rows, parameters.columns, m}, std::move(pixels), std::move(samples));
}

}  // namespace landfall
