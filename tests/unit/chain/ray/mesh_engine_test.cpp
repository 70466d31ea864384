// SPDX-License-Identifier: GPL-3.0-or-later
// Rays on meshes: closed forms, and the two engines against each other on rays that tempt a leak.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>

#include "brute_force.h"
#include "chain/terrain/mesh/mesh_shapes.h"
#include "chain/terrain/mesh/triangle_mesh.h"
#include "scenes.h"

namespace landfall {
namespace {

using Mesh = std::shared_ptr<const TriangleMesh>;

Mesh mesh_of(IndexedTriangles mesh) { return std::make_shared<const TriangleMesh>(std::move(mesh)); }

double range_of(const Mesh& mesh, const Ray& ray) {
  const double range = ranges_of(*make_cgal_engine(mesh), {ray}).front();
  const double brute = ranges_of(*make_brute_force_engine(mesh), {ray}).front();
  EXPECT_EQ(std::isnan(range), std::isnan(brute));
  if (!std::isnan(range)) {
    EXPECT_NEAR(range, brute, 1e-9);
  }
  return range;
}

TEST(MeshEngine, CubeFromOutsideAndInside) {
  const Mesh cube = mesh_of(cube_mesh());
  EXPECT_EQ(range_of(cube, ray_from({0.3, 0.2, 10}, {0, 0, -1})), 9);
  EXPECT_EQ(range_of(cube, ray_from({0, 0, 0.5}, {0, 0, -1})), 1.5);
  EXPECT_EQ(range_of(cube, ray_from({0, 0, 0.5}, {0, 1, 0})), 1);
  EXPECT_NEAR(range_of(cube, ray_at({5, 5, 5}, {0, 0, 0})), 4 * std::sqrt(3.0), 1e-12);  // at a corner
  EXPECT_EQ(range_of(cube, ray_from({1, -5, 0}, {0, 1, 0})), 4);                         // along a face
  EXPECT_TRUE(std::isnan(range_of(cube, ray_from({1 + 1e-12, -5, 0}, {0, 1, 0}))));
}

TEST(MeshEngine, TetrahedronIsAPlane) {
  const Mesh mesh = mesh_of(tetrahedron_mesh());
  const Eigen::Vector3d origin(2, 3, 4);
  const Eigen::Vector3d target(0.2, 0.3, 0.5);  // on x + y + z = 1
  EXPECT_NEAR(range_of(mesh, ray_at(origin, target)), (target - origin).norm(), 1e-12);
}

// A tilted ray from below the cap's rim meets its underside; the highest surface there is 1 m further up.
TEST(MeshEngine, OverhangFromBelow) {
  const Mesh mushroom = mesh_of(mushroom_mesh());
  const Eigen::Vector3d origin(8, 0.5, 0.5);
  const Eigen::Vector3d target(2, 0.25, 3);
  EXPECT_NEAR(range_of(mushroom, ray_at(origin, target)), (target - origin).norm(), 1e-12);
  EXPECT_EQ(mushroom->elevation(2, 0.25), 4);
  EXPECT_EQ(range_of(mushroom, ray_from({8, 0.25, 1}, {-1, 0, 0})), 7);  // the stem
  EXPECT_EQ(range_of(mushroom, ray_from({2, 0.25, 9}, {0, 0, -1})), 5);
}

TEST(MeshEngine, SphereWithinItsSag) {
  const Mesh sphere = mesh_of(sphere_mesh(5));
  Random random(test_seed());
  for (int i = 0; i < 300; ++i) {
    const Eigen::Vector3d origin(uniform(random, -3, 3), uniform(random, -3, 3), 5);
    const double range = range_of(sphere, ray_at(origin, Eigen::Vector3d::Zero()));
    EXPECT_NEAR(range, origin.norm() - 1, 1e-3);
    EXPECT_GE(range, origin.norm() - 1 - 1e-12);
  }
}

/// Rays aimed at the corners of all triangles and at a point of each of their edges. Where the target is on
/// the rim, past which a ray may go by with good reason, it is left out.
std::vector<Ray> aimed_rays(const TriangleMesh& mesh, Random& random,
                            const std::function<bool(const Eigen::Vector3d&, const Ray&)>& on_rim) {
  std::vector<Ray> rays;
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto t = mesh.triangle(i);
      const Eigen::Vector3d origin(uniform(random, -0.3, 0.3), uniform(random, -0.3, 0.3), 20);
      for (const Eigen::Vector3d& target :
           {t[k], Eigen::Vector3d(t[k] + uniform(random, 0, 1) * (t[(k + 1) % 3] - t[k]))})
        if (const Ray ray = ray_at(origin, target); !on_rim(target, ray)) rays.push_back(ray);
    }
  return rays;
}

void expect_no_leak(const Mesh& mesh, const std::vector<Ray>& rays) {
  ASSERT_GT(rays.size(), mesh->triangle_count());
  const auto ranges = ranges_of(*make_cgal_engine(mesh), rays);
  const auto brute = ranges_of(*make_brute_force_engine(mesh), rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_FALSE(std::isnan(ranges[i])) << i;
    ASSERT_NEAR(ranges[i], brute[i], 1e-9) << i;
  }
}

TEST(MeshEngine, NoRayThroughAVertexOrAnEdgeLeaks) {
  Random random(test_seed());
  const Mesh sheet = mesh_of(rough_sheet(random, 12));
  expect_no_leak(sheet, aimed_rays(*sheet, random, [](const Eigen::Vector3d& target, const Ray&) {
                   return target.head<2>().cwiseAbs().maxCoeff() > 0.99;
                 }));
  const Mesh sphere = mesh_of(sphere_mesh(3));
  expect_no_leak(sphere, aimed_rays(*sphere, random, [](const Eigen::Vector3d& target, const Ray& ray) {
                   return std::abs(target.normalized().dot(ray.direction.v)) < 0.2;
                 }));
}

TEST(MeshEngine, AgreesWithAllTrianglesOnAnyMesh) {
  Random random(test_seed());
  const Mesh mesh = mesh_of(random_mesh(random, 1500));
  std::vector<Ray> rays;
  for (int i = 0; i < 2000; ++i) {
    const auto t = mesh->triangle(random() % mesh->triangle_count());
    const Eigen::Vector3d origin(uniform(random, -15, 15), uniform(random, -15, 15),
                                 uniform(random, -15, 15));
    rays.push_back(ray_at(origin, 0.4 * t[0] + 0.35 * t[1] + 0.25 * t[2]));
  }
  const auto ranges = ranges_of(*make_cgal_engine(mesh), rays);
  const auto brute = ranges_of(*make_brute_force_engine(mesh), rays);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    ASSERT_FALSE(std::isnan(ranges[i])) << i;
    EXPECT_NEAR(ranges[i], brute[i], 1e-9) << i;
  }
}

}  // namespace
}  // namespace landfall
