// SPDX-License-Identifier: GPL-3.0-or-later
#include "embree_engine.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace landfall {
namespace {

constexpr std::size_t kPacket = 16;

class EmbreeEngine final : public RayEngine {
 public:
  explicit EmbreeEngine(std::shared_ptr<const TriangulatedGrid> terrain)
      : terrain_(std::move(terrain)), device_(rtcNewDevice(nullptr)), scene_(rtcNewScene(device_)) {
    RTCGeometry mesh = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    copy_nodes(mesh);
    copy_triangles(mesh);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene_, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene_);
  }
  EmbreeEngine(const EmbreeEngine&) = delete;
  EmbreeEngine& operator=(const EmbreeEngine&) = delete;
  ~EmbreeEngine() override {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  void first_hits(std::span<const Ray> rays, std::span<double> ranges) const override {
    for (std::size_t begin = 0; begin < rays.size(); begin += kPacket) {
      const std::size_t count = std::min(kPacket, rays.size() - begin);
      trace(rays.subspan(begin, count), ranges.subspan(begin, count));
    }
  }

 private:
  void copy_nodes(RTCGeometry mesh) const {
    const GridSpec& spec = terrain_->nodes().spec();
    auto* out = static_cast<float*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), spec.size()));
    for (std::int64_t row = 0; row < spec.rows; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        *out++ = static_cast<float>(spec.x(col));
        *out++ = static_cast<float>(spec.y(row));
        *out++ = static_cast<float>(terrain_->nodes().at({row, col}));
      }
  }

  void copy_triangles(RTCGeometry mesh) const {
    const GridSpec& spec = terrain_->nodes().spec();
    auto* out = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), terrain_->triangle_count()));
    const auto node = [&](std::int64_t row, std::int64_t col) {
      return static_cast<unsigned>(spec.index({row, col}));
    };
    for (std::int64_t row = 0; row + 1 < spec.rows; ++row)
      for (std::int64_t col = 0; col + 1 < spec.cols; ++col)
        for (const unsigned corner : {node(row, col), node(row, col + 1), node(row + 1, col),
                                      node(row, col + 1), node(row + 1, col + 1), node(row + 1, col)})
          *out++ = corner;
  }

  void trace(std::span<const Ray> rays, std::span<double> ranges) const {
    alignas(64) RTCRayHit16 packet;
    alignas(64) int valid[kPacket];
    for (std::size_t i = 0; i < kPacket; ++i) {
      const Ray& ray = rays[std::min(i, rays.size() - 1)];
      valid[i] = i < rays.size() ? -1 : 0;
      packet.ray.org_x[i] = static_cast<float>(ray.origin.v.x());
      packet.ray.org_y[i] = static_cast<float>(ray.origin.v.y());
      packet.ray.org_z[i] = static_cast<float>(ray.origin.v.z());
      packet.ray.dir_x[i] = static_cast<float>(ray.direction.v.x());
      packet.ray.dir_y[i] = static_cast<float>(ray.direction.v.y());
      packet.ray.dir_z[i] = static_cast<float>(ray.direction.v.z());
      packet.ray.tnear[i] = 0;
      packet.ray.tfar[i] = std::numeric_limits<float>::infinity();
      packet.ray.time[i] = 0;
      packet.ray.mask[i] = ~0U;
      packet.ray.id[i] = 0;
      packet.ray.flags[i] = 0;
      packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
      packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene_, &context, &packet);
    for (std::size_t i = 0; i < rays.size(); ++i)
      ranges[i] = packet.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::quiet_NaN()
                                                                  : refined(rays[i], packet.hit.primID[i]);
  }

  [[nodiscard]] double refined(const Ray& ray, std::size_t triangle) const {
    const auto corners = terrain_->triangle(triangle);
    const Eigen::Vector3d normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    return normal.dot(corners[0] - ray.origin.v) / normal.dot(ray.direction.v);
  }

  std::shared_ptr<const TriangulatedGrid> terrain_;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace

std::unique_ptr<RayEngine> make_embree_engine(std::shared_ptr<const TriangulatedGrid> terrain) {
  return std::make_unique<EmbreeEngine>(std::move(terrain));
}

}  // namespace landfall
