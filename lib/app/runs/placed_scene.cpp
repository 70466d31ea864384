// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/placed_scene.h"

#include <utility>

namespace landfall {
namespace {

class PlacedSurface final : public TerrainSurface {
 public:
  PlacedSurface(std::shared_ptr<const TerrainSurface> terrain, Placement placement)
      : terrain_(std::move(terrain)), placement_(std::move(placement)) {}

  [[nodiscard]] double elevation(double x_m, double y_m) const override {
    const SitePoint at = placement_.to_second({x_m, y_m});
    return terrain_->elevation(at.x_m, at.y_m) + placement_.shift_m()[2];
  }
  [[nodiscard]] double highest_m() const override { return terrain_->highest_m() + placement_.shift_m()[2]; }
  [[nodiscard]] Eigen::Vector3d normal(const Eigen::Vector3d& point) const override {
    const SitePoint at = placement_.to_second({point.x(), point.y()});
    return terrain_->normal({at.x_m, at.y_m, point.z() - placement_.shift_m()[2]});
  }
  [[nodiscard]] bool is_terrain_below() const override { return terrain_->is_terrain_below(); }

 private:
  std::shared_ptr<const TerrainSurface> terrain_;
  Placement placement_;
};

}  // namespace

Scene placed_scene(Scene scene, const Placement& placement) {
  if (placement.is_identity() || scene.surface == nullptr) return scene;
  scene.surface = std::make_shared<const PlacedSurface>(std::move(scene.surface), placement);
  scene.engine.reset();
  scene.engine_name = "none";
  return scene;
}

void require_window(const Scene& scene, const GridSpec& grid, const Placement& placement) {
  if (!scene.window) return;
  TerrainBox box;
  const std::int64_t last_row = grid.rows - 1;
  const std::int64_t last_col = grid.cols - 1;
  const auto add = [&](std::int64_t row, std::int64_t col) {
    const SitePoint at = placement.to_second({grid.x(col), grid.y(row)});
    box.add(at.x_m, at.y_m);
  };
  // A reprojected border bends outwards between its corners.
  for (std::int64_t row = 0; row <= last_row; ++row)
    for (const std::int64_t col : {std::int64_t{0}, last_col}) add(row, col);
  for (std::int64_t col = 0; col <= last_col; ++col)
    for (const std::int64_t row : {std::int64_t{0}, last_row}) add(row, col);
  scene.window->require(box);
}

}  // namespace landfall
