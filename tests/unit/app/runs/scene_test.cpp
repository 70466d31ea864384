// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "base/core/error.h"
#include "bins.h"
#include "refusal.h"
#include "store/files/mesh_terrain_file.h"
#include "temporary_folder.h"

namespace landfall {
namespace {

using testing::HasSubstr;

const std::string kCrs = "LOCAL_CS[\"a frame\"]";
const nlohmann::json kRaster = {{{"tool", "gdal"}, {"file_id", "r"}}};
const Provenance kProvenance{.tool = "terrain-gen", .config = {{"a", 1}}, .chain = kRaster};

/// z = 1 + x / 4, y from -1.5 to 1.5 and x from -2 to 2 m.
GeneratedTerrain slope() {
  GeneratedTerrain terrain;
  terrain.crs_wkt = kCrs;
  terrain.nodes = Grid<double>({0.5, -3, -4, 7, 9});
  for (const auto [row, col] : Bins({0, 0}, {7, 9}))
    terrain.nodes.at({row, col}) = 1 + 0.125 * static_cast<double>(col - 4);
  return terrain;
}

class SceneFiles : public testing::Test {
 protected:
  SceneFiles() {
    LandfallFileWriter grid({grid_}, "terrain", kProvenance);
    write_terrain(grid, slope());
    LandfallFileWriter mesh({mesh_}, "terrain", kProvenance);
    write_mesh_terrain(mesh,
                       {{{-2, -2, 0.5}, {2, -2, 1.5}, {-2, 2, 0.5}, {2, 2, 1.5}}, {{0, 1, 2}, {1, 3, 2}}});
  }

  TemporaryFolder folder_;
  std::filesystem::path grid_ = folder_ / "grid.h5";
  std::filesystem::path mesh_ = folder_ / "mesh.h5";
};

double range_down(const Scene& scene, double x_m, double y_m) {
  const std::array<Ray, 1> rays = {Ray{{{x_m, y_m, 10}}, {{0, 0, -1}}}};
  std::array<double, 1> ranges{};
  scene.engine->first_hits(rays, ranges);
  return ranges[0];
}

/// The slope by its surface and, where rays are asked for, by its engine.
void expect_slope(const Scene& scene) {
  EXPECT_NEAR(scene.surface->elevation(0.8, 0.3), 1.2, 1e-11);  // a window rounds places to 2^-36 cells
  EXPECT_NEAR(std::abs(scene.surface->normal({0.8, 0.3, 1.2}).x()), 0.25 / std::hypot(0.25, 1), 1e-12);
  EXPECT_TRUE(std::isnan(scene.surface->elevation(3, 0)));
  if (!scene.engine) return;
  EXPECT_NEAR(range_down(scene, 0.8, 0.3), 8.8, 1e-9);
  EXPECT_TRUE(std::isnan(range_down(scene, 3, 0)));
}

void expect_identity(const Scene& scene, const std::string& crs_wkt) {
  EXPECT_EQ(scene.crs_wkt, crs_wkt);
  EXPECT_EQ(scene.file_id, kProvenance.file_id());
  EXPECT_EQ(scene.chain.size(), 2U);
}

TEST_F(SceneFiles, AGridIsTracedByEitherEngine) {
  for (const auto& [kind, name] :
       {std::pair{EngineKind::automatic, "heightfield"}, std::pair{EngineKind::heightfield, "heightfield"},
        std::pair{EngineKind::cgal, "cgal"}}) {
    const Scene scene = open_scene({.terrain = grid_, .engine = kind});
    EXPECT_EQ(scene.engine_name, name);
    EXPECT_EQ(scene.window, nullptr);
    expect_identity(scene, kCrs);
    expect_slope(scene);
  }
}

TEST_F(SceneFiles, ALargeGridIsLoadedInPart) {
  for (const auto& [kind, name] :
       {std::pair{EngineKind::automatic, "heightfield"}, std::pair{EngineKind::cgal, "cgal"}}) {
    const Scene scene = open_scene({.terrain = grid_, .engine = kind, .max_loaded_nodes = 62});
    ASSERT_NE(scene.window, nullptr);
    EXPECT_EQ(scene.window->window().size(), 0U);
    EXPECT_EQ(scene.engine_name, name);
    expect_identity(scene, kCrs);
    expect_slope(scene);
    EXPECT_GT(scene.window->window().size(), 0U);
  }
  EXPECT_EQ(open_scene({.terrain = grid_, .max_loaded_nodes = 63}).window, nullptr);
}

TEST_F(SceneFiles, AMeshIsTracedByCgal) {
  for (const EngineKind kind : {EngineKind::automatic, EngineKind::cgal}) {
    const Scene scene = open_scene({.terrain = mesh_, .engine = kind, .max_loaded_nodes = 1});
    EXPECT_EQ(scene.engine_name, "cgal");
    EXPECT_FALSE(scene.surface->is_terrain_below());
    expect_identity(scene, kLocalSiteCrsWkt);
    expect_slope(scene);
  }
  EXPECT_EQ(refusal([&] { return open_scene({.terrain = mesh_, .engine = EngineKind::heightfield}); }),
            mesh_.string() + ": is a mesh, which the engine heightfield cannot trace; use cgal or auto");
}

TEST_F(SceneFiles, ASurfaceAloneHasNoEngine) {
  for (const std::int64_t nodes : {62, 63}) {
    const Scene scene = open_scene({.terrain = grid_, .use = SceneUse::surface, .max_loaded_nodes = nodes});
    EXPECT_EQ(scene.engine, nullptr);
    EXPECT_EQ(scene.engine_name, "none");
    EXPECT_EQ(scene.window != nullptr, nodes == 62);
    expect_identity(scene, kCrs);
    expect_slope(scene);
  }
  // For a mesh it does not matter which engine could trace it.
  expect_slope(open_scene({.terrain = mesh_, .use = SceneUse::surface, .engine = EngineKind::heightfield}));
}

TEST_F(SceneFiles, AnIdentityHasNoGround) {
  for (const auto& [path, crs_wkt] :
       {std::pair{grid_, kCrs}, std::pair{mesh_, std::string(kLocalSiteCrsWkt)}}) {
    const Scene scene = open_scene({.terrain = path, .use = SceneUse::identity});
    EXPECT_EQ(scene.surface, nullptr);
    EXPECT_EQ(scene.engine, nullptr);
    EXPECT_EQ(scene.engine_name, "none");
    expect_identity(scene, crs_wkt);
  }
}

TEST(Scene, WithoutATerrainIsLevelGroundWithoutEnd) {
  const Scene scene = open_scene({});
  EXPECT_EQ(scene.engine_name, "flat");
  EXPECT_EQ(range_down(scene, 1e9, -1e9), 10);
  EXPECT_EQ(scene.surface->elevation(1e9, -1e9), 0);
  EXPECT_EQ(scene.surface->highest_m(), 0);
  EXPECT_EQ(scene.surface->normal({5, 6, 0}), Eigen::Vector3d(0, 0, 1));
  EXPECT_TRUE(scene.surface->is_terrain_below());
  EXPECT_EQ(scene.file_id, "");
}

TEST_F(SceneFiles, WhatIsNoTerrainIsRefused) {
  const std::filesystem::path dem = folder_ / "dem.h5";
  LandfallFileWriter({dem}, "dem", kProvenance).commit();
  GeneratedTerrain hole;
  hole.nodes = Grid<double>({0.5, 0, 0, 2, 2}, std::nan(""));
  LandfallFileWriter holes({folder_ / "holes.h5"}, "terrain", kProvenance);
  write_terrain(holes, hole);
  for (const SceneUse use : {SceneUse::identity, SceneUse::surface, SceneUse::rays}) {
    EXPECT_THAT([&] { return open_scene({.terrain = folder_ / "none.h5", .use = use}); },
                testing::ThrowsMessage<FormatError>(HasSubstr("none.h5")));
    EXPECT_THAT([&] { return open_scene({.terrain = dem, .use = use}); },
                testing::ThrowsMessage<FormatError>(HasSubstr("dem.h5")));
    if (use == SceneUse::identity) continue;
    for (const std::int64_t nodes : {1, 100})
      EXPECT_THAT(
          [&] {
            return open_scene({.terrain = folder_ / "holes.h5", .use = use, .max_loaded_nodes = nodes});
          },
          testing::ThrowsMessage<FormatError>(HasSubstr("no finite node")));
  }
}

TEST_F(SceneFiles, ProgressRisesToOne) {
  for (const auto& path : {grid_, mesh_}) {
    std::vector<double> fractions;
    static_cast<void>(open_scene({.terrain = path}, [&](double fraction) { fractions.push_back(fraction); }));
    EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
    ASSERT_FALSE(fractions.empty());
    EXPECT_EQ(fractions.back(), 1);
  }
}

}  // namespace
}  // namespace landfall
