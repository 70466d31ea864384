// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstddef>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "app/host/lidar.h"
#include "app/python/engine.h"
#include "app/runs/scene.h"
#include "base/core/parallel.h"

namespace landfall::python {
namespace {

constexpr std::size_t kRaysAtOnce = 324;  // engines are tuned for the rays of one pulse

/// Calls work(begin, end) on all threads, or on as many as are asked for.
void on_threads(std::size_t count, std::size_t grain, std::size_t threads,
                const std::function<void(std::size_t, std::size_t)>& work) {
  const ThreadLimit limit(threads);
  parallel_for(count, grain, work);
}

struct Surface : Object {
  explicit Surface(const char* file) : scene(open_scene({.terrain = file})) {}
  Scene scene;
};

landfall::Ray ray_of(const lidar::Ray& ray) {
  const auto& [x, y, z] = ray.origin_m;
  const auto& [a, b, c] = ray.direction;
  return {{{x, y, z}}, {{a, b, c}}};
}

lidar::IntersectAll traced_by(std::shared_ptr<const RayEngine> engine) {
  return [engine = std::move(engine)](std::span<const lidar::Ray> rays, std::span<double> ranges_m) {
    thread_local std::vector<landfall::Ray> own;
    own.clear();
    for (const lidar::Ray& ray : rays) own.push_back(ray_of(ray));
    engine->first_hits(own, ranges_m);
  };
}

/// The rays of one pulse, which Python traces.
struct Rays : Object {
  std::vector<lidar::Ray> rays;
};

thread_local Rays* wanted_rays = nullptr;             ///< get the rays of the pulse, which then misses
thread_local const double* known_ranges_m = nullptr;  ///< else its ranges

void trace_in_python(std::span<const lidar::Ray> rays, std::span<double> ranges_m) {
  if (wanted_rays == nullptr) {
    std::copy_n(known_ranges_m, rays.size(), ranges_m.begin());
    return;
  }
  wanted_rays->rays.assign(rays.begin(), rays.end());
  std::ranges::fill(ranges_m, std::numeric_limits<double>::quiet_NaN());
}

/// lidar::PixelReturn as a record of numpy.
nlohmann::json record_type() {
  using Pixel = lidar::PixelReturn;
  nlohmann::json names, formats, offsets;
  const auto add = [&](const char* name, const char* format, std::size_t offset) {
    names.push_back(name);
    formats.push_back(format);
    offsets.push_back(offset);
  };
  add("pixel", "i4", offsetof(Pixel, pixel));
  add("status", "i1", offsetof(Pixel, status));
  add("range_true_m", "f8", offsetof(Pixel, range_true_m));
  add("range_measured_m", "f8", offsetof(Pixel, range_measured_m));
  add("true_m", "3f8", offsetof(Pixel, true_m));
  add("estimated_m", "3f8", offsetof(Pixel, estimated_m));
  return {{"names", names}, {"formats", formats}, {"offsets", offsets}, {"itemsize", sizeof(Pixel)}};
}

std::optional<lidar::Pose> pose_of(const double* poses, std::size_t i) {
  if (poses == nullptr) return std::nullopt;
  const double* const row = poses + 7 * i;
  return lidar::Pose{{row[0], row[1], row[2]}, {row[3], row[4], row[5], row[6]}};
}

lidar::Pulse pulse_of(const PulseArrays& pulses, std::size_t i) {
  lidar::Pulse pulse{.number = pulses.numbers[i],
                     .truth = *pose_of(pulses.truth, i),
                     .estimate = pose_of(pulses.estimates, i),
                     .nominal = pose_of(pulses.nominals, i)};
  if (pulses.t_s != nullptr) pulse.since_start_s = pulses.t_s[i];
  return pulse;
}

struct HeldLidar : Object {
  HeldLidar(const char* config, lidar::IntersectAll trace)
      : instrument(config, std::move(trace), "the configuration") {}
  lidar::Instrument instrument;
};

}  // namespace

Object* landfall_new_surface(const char* file) {
  return object_of([&] { return new Surface(file); });
}

bool landfall_surface_elevation(Object* surface, std::size_t count, const double* x_m, const double* y_m,
                                double* z_m, std::size_t threads) {
  return succeeds([&] {
    const TerrainSurface& terrain = *as<Surface>(surface).scene.surface;
    on_threads(count, 4096, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) z_m[i] = terrain.elevation(x_m[i], y_m[i]);
    });
  });
}

bool landfall_surface_first_hit(Object* surface, std::size_t count, const double* origins,
                                const double* directions, double* ranges_m, std::size_t threads) {
  return succeeds([&] {
    const RayEngine& engine = *as<Surface>(surface).scene.engine;
    const std::span ranges(ranges_m, count);
    on_threads(count, kRaysAtOnce, threads, [&](std::size_t begin, std::size_t end) {
      std::vector<landfall::Ray> rays(end - begin);
      for (std::size_t i = begin; i < end; ++i)
        rays[i - begin] = {{{origins[3 * i], origins[3 * i + 1], origins[3 * i + 2]}},
                           {{directions[3 * i], directions[3 * i + 1], directions[3 * i + 2]}}};
      engine.first_hits(rays, ranges.subspan(begin, end - begin));
    });
  });
}

Object* landfall_new_lidar(const char* config, Object* surface) {
  return object_of([&] {
    return new HeldLidar(config,
                         surface == nullptr ? trace_in_python : traced_by(as<Surface>(surface).scene.engine));
  });
}

const char* landfall_lidar(Object* lidar) {
  return text_of([&] {
    const lidar::Instrument& instrument = as<HeldLidar>(lidar).instrument;
    nlohmann::json description = {{"pulse_rate_hz", instrument.pulse_rate_hz()},
                                  {"pixel_count", instrument.pixel_count()},
                                  {"pulse_limit", nullptr},
                                  {"record", record_type()}};
    if (const auto limit = instrument.pulse_limit()) description["pulse_limit"] = *limit;
    return description.dump();
  });
}

Object* landfall_new_rays(Object* lidar, const PulseArrays* pulse) {
  return object_of([&] {
    auto rays = std::make_unique<Rays>();
    wanted_rays = rays.get();
    const bool is_done = succeeds([&] { (void)as<HeldLidar>(lidar).instrument.step(pulse_of(*pulse, 0)); });
    wanted_rays = nullptr;
    return is_done ? rays.release() : nullptr;
  });
}

const char* landfall_rays(Object* rays) {
  return text_of([&] {
    static_assert(sizeof(lidar::Ray) == 6 * sizeof(double));
    const std::vector<lidar::Ray>& held = as<Rays>(rays).rays;
    const nlohmann::json shape = {held.size(), 2, 3};
    return nlohmann::json(
               {{"type", "f8"}, {"shape", shape}, {"address", reinterpret_cast<std::uintptr_t>(held.data())}})
        .dump();
  });
}

bool landfall_lidar_pulses(Object* lidar, const PulseArrays* pulses, const double* ranges_m, void* records,
                           std::size_t threads) {
  return succeeds([&] {
    const lidar::Instrument& instrument = as<HeldLidar>(lidar).instrument;
    const std::size_t pixels = instrument.pixel_count();
    auto* const out = static_cast<lidar::PixelReturn*>(records);
    const auto steps = [&](std::size_t begin, std::size_t end) {
      lidar::PulseReturns returns;
      for (std::size_t i = begin; i < end; ++i) {
        instrument.step(pulse_of(*pulses, i), returns);
        std::ranges::copy(returns.pixels, out + i * pixels);
      }
    };
    known_ranges_m = ranges_m;
    if (pulses->count == 1)
      steps(0, 1);
    else
      on_threads(pulses->count, 16, threads, steps);
  });
}

}  // namespace landfall::python
