// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D438
#include "app/runs/geodetic_cloud.h"

#include <numbers>
#include <utility>

#include "base/core/parallel.h"
#include "chain/terrain/relief/geodetic.h"

namespace landfall {
namespace {

constexpr std::size_t kConvertedPerPiece = 1U << 12U;
constexpr double kDegrees = 180 / std::numbers::pi;

class GeodeticCloud final : public CloudReader {
 public:
  GeodeticCloud(std::unique_ptr<CloudReader> cloud, const BodyFixed& frame)
      : cloud_(std::move(cloud)), frame_(frame) {
    info_ = cloud_->info();
  }
  bool next(CloudBatch& batch) override {
    if (!cloud_->next(batch)) return false;
    parallel_for(batch.size(), kConvertedPerPiece, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) convert(batch, i);
    });
    return true;
  }
  void rewind() override { cloud_->rewind(); }
  [[nodiscard]] double progress() const override { return cloud_->progress(); }

 private:
  void convert(CloudBatch& batch, std::size_t i) const {
    const Eigen::Vector3d p(batch.columns[0][i], batch.columns[1][i], batch.columns[2][i]);
    const Geodetic at = geodetic_of(frame_.body, frame_.metres_per_unit * p);
    batch.columns[0][i] = at.lon_lat.lon_rad * kDegrees;
    batch.columns[1][i] = at.lon_lat.lat_rad * kDegrees;
    batch.columns[2][i] = at.height_m;
  }

  std::unique_ptr<CloudReader> cloud_;
  BodyFixed frame_;
};

}  // namespace

std::unique_ptr<CloudReader> geodetic_cloud(std::unique_ptr<CloudReader> body_fixed, const BodyFixed& frame) {
  return std::make_unique<GeodeticCloud>(std::move(body_fixed), frame);
}

}  // namespace landfall
