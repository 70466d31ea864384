// SPDX-License-Identifier: GPL-3.0-or-later
// The ray engines on the same rays, one thread, in one run, and the heightfield engine on two threads and one
// in turns; the ratios of their rates come last.
//   bench_rays [--benchmark_filter=relief ...]
// Times move with whatever else the machine does: each engine's best of three repetitions counts.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <iostream>
#include <limits>
#include <map>
#include <numbers>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "chain/ray/cgal_engine.h"
#include "chain/ray/heightfield_engine.h"
#ifdef LANDFALL_BENCH_EMBREE
#include "embree_engine.h"
#endif

namespace landfall {
namespace {

using Terrain = std::shared_ptr<const TriangulatedGrid>;

constexpr std::size_t kPulseRays = 18 * 18;
constexpr const char* kByTwo = "/heightfield_2_threads";
constexpr const char* kRate = "items_per_second";
constexpr const char* kByOneRate = "by_one_thread_per_second";

template <class Height>
Terrain terrain_of(Height height) {
  const GridSpec spec = GridSpec::centered(60, 0.05);
  Grid<double> nodes(spec);
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      nodes.at({row, col}) = height(spec.x(col), spec.y(row));
  return std::make_shared<const TriangulatedGrid>(std::move(nodes));
}

/// The paper's ten cones of 10 m on a plane.
Terrain cones() {
  return terrain_of([](double x, double y) {
    double z = 0;
    for (int i = 0; i < 10; ++i) {
      const double azimuth = 0.199 + 0.2 * std::numbers::pi * i;
      const double distance = std::hypot(x - 21.1 * std::cos(azimuth), y - 21.1 * std::sin(azimuth));
      z = std::max(z, 10 * (1 - distance / 3));
    }
    return z;
  });
}

/// Sums of sines from 100 m down to 0.2 m of wavelength: about 10 m of relief, rough at the size of a cell.
Terrain relief() {
  return terrain_of([](double x, double y) {
    double z = 0;
    for (int octave = 0; octave < 10; ++octave) {
      const double wave = 2 * std::numbers::pi / 100 * std::exp2(octave);
      z += 4 * std::exp2(-octave) * std::sin(wave * x + octave) * std::sin(wave * y - 2 * octave);
    }
    return z;
  });
}

struct View {
  Eigen::Vector3d origin_m;
  Eigen::Vector3d target_m;
};

/// One pulse of the paper's detector, 18 x 18 rays in pixel order.
void append_pulse(const View& view, std::vector<Ray>& rays) {
  constexpr double kIfov_rad = 8.888888888888889e-5;
  const Eigen::Vector3d boresight = (view.target_m - view.origin_m).normalized();
  const Eigen::Vector3d down = boresight.cross(Eigen::Vector3d::UnitX()).normalized();
  const Eigen::Vector3d right = down.cross(boresight);
  for (int row = 0; row < 18; ++row)
    for (int col = 0; col < 18; ++col) {
      const double x = std::tan((col - 8.5) * kIfov_rad);
      const double y = std::tan((row - 8.5) * kIfov_rad);
      rays.push_back({{view.origin_m}, {(boresight + x * right + y * down).normalized()}});
    }
}

struct Scene {
  const char* name;
  Terrain (*terrain)();
  Eigen::Vector3d origin_m;
  double target_z_m;
};

/// A raster of pulses at 100 m x 100 m.
std::vector<Ray> scan_of(const Scene& scene) {
  constexpr int kPulses = 56;
  std::vector<Ray> rays;
  for (int row = 0; row < kPulses; ++row)
    for (int col = 0; col < kPulses; ++col)
      append_pulse(
          {scene.origin_m,
           {100.0 * (col + 0.47) / kPulses - 50, 100.0 * (row + 0.31) / kPulses - 50, scene.target_z_m}},
          rays);
  return rays;
}

struct EngineKind {
  const char* name;
  std::unique_ptr<RayEngine> (*make)(Terrain);
};

const std::vector<Scene>& scenes() {
  static const std::vector<Scene> all = {
      {"cones", cones, {0, 0, 500}, 0},
      {"cones_45deg", cones, {-500, 3, 500}, 0},
      {"relief", relief, {0, 0, 500}, 0},
      {"relief_45deg", relief, {-500, 3, 500}, 0},
      {"relief_80deg", relief, {-689, 3, 121}, 0},
      {"relief_over_the_side", relief, {-80, 3, 4}, 0},  // below the summits where it enters the grid
      {"relief_upward", relief, {3.02, 2.01, -1}, 10},   // from among the summits to the sky
      {"relief_from_below", relief, {0, 0, -200}, 0},
  };
  return all;
}

const std::vector<EngineKind>& engine_kinds() {
  static const std::vector<EngineKind> all = [] {
    std::vector<EngineKind> kinds = {
        {"heightfield", [](Terrain terrain) { return make_heightfield_engine(std::move(terrain)); }},
#ifdef LANDFALL_BENCH_EMBREE
        {"embree16", make_embree_engine},
#endif
        {"cgal", [](Terrain terrain) { return make_cgal_engine(std::move(terrain)); }},
    };
    return kinds;
  }();
  return all;
}

/// An engine over a scene, kept until another one is asked for: the library runs each benchmark many times.
const RayEngine& engine_over(const Scene& scene, const EngineKind& kind) {
  static const Scene* held_scene = nullptr;
  static const EngineKind* held_kind = nullptr;
  static Terrain terrain;
  static std::unique_ptr<RayEngine> engine;
  if (held_scene != &scene) terrain = scene.terrain();
  if (held_scene != &scene || held_kind != &kind) {
    engine.reset();
    engine = kind.make(terrain);
  }
  held_scene = &scene;
  held_kind = &kind;
  return *engine;
}

void trace(benchmark::State& state, const Scene& scene, const EngineKind& kind) {
  const RayEngine& engine = engine_over(scene, kind);
  const std::vector<Ray> rays = scan_of(scene);
  constexpr std::size_t maximum = kPulseRays;
  std::vector<double> ranges(rays.size());
  for (auto _ : state)
    for (std::size_t begin = 0; begin < rays.size(); begin += maximum) {
      const std::size_t count = std::min(maximum, rays.size() - begin);
      engine.first_hits(std::span(rays).subspan(begin, count), std::span(ranges).subspan(begin, count));
      benchmark::DoNotOptimize(ranges.data());
    }
  state.SetItemsProcessed(static_cast<std::int64_t>(rays.size()) * state.iterations());
}

/// Seconds that as many threads need for all pulses; each takes the next pulse when it is free.
double seconds_by(std::size_t threads, const RayEngine& engine, std::span<const Ray> rays) {
  std::atomic<std::size_t> next = 0;
  const auto trace_pulses = [&] {
    std::vector<double> ranges(kPulseRays);
    for (std::size_t begin = 0; (begin = next.fetch_add(kPulseRays)) < rays.size();)
      engine.first_hits(rays.subspan(begin, kPulseRays), ranges);
  };
  const auto start = std::chrono::steady_clock::now();
  {
    std::vector<std::jthread> others(threads - 1);
    for (std::jthread& other : others) other = std::jthread(trace_pulses);
    trace_pulses();
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// The heightfield engine on two threads and on one, in turns; the best rate of each is kept.
void trace_by_two(benchmark::State& state, const Scene& scene) {
  const RayEngine& engine = engine_over(scene, engine_kinds().front());
  const std::vector<Ray> rays = scan_of(scene);
  double by_one_s = std::numeric_limits<double>::infinity();
  double by_two_s = by_one_s;
  for (auto _ : state) {
    by_one_s = std::min(by_one_s, seconds_by(1, engine, rays));
    const double seconds = seconds_by(2, engine, rays);
    by_two_s = std::min(by_two_s, seconds);
    state.SetIterationTime(seconds);
  }
  const auto count = static_cast<double>(rays.size());
  state.counters[kByOneRate] = count / by_one_s;
  state.counters[kRate] = count / by_two_s;
}

/// Keeps each benchmark's best rate beside what the console shows.
class BestRates : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration) continue;
      for (const char* const name : {kRate, kByOneRate}) {
        const auto rate = run.counters.find(name);
        if (rate == run.counters.end()) continue;
        double& best = rates_[run.run_name.function_name][name];
        best = std::max(best, static_cast<double>(rate->second));
      }
    }
  }

  void print_ratios() const {
    for (const Scene& scene : scenes()) {
      const double own = rate(scene, "/heightfield", kRate);
      for (const EngineKind& kind : engine_kinds()) {
        const std::string engine = std::string("/") + kind.name;
        const double other = rate(scene, engine, kRate);
        if (own > 0 && other > 0)
          std::cout << scene.name << engine << ": " << other / 1e6 << " M rays/s, heightfield is "
                    << own / other << " x\n";
      }
      const double by_two = rate(scene, kByTwo, kRate);
      if (by_two > 0)
        std::cout << scene.name << kByTwo << ": " << by_two / 1e6 << " M rays/s, "
                  << by_two / rate(scene, kByTwo, kByOneRate) << " x one thread\n";
    }
  }

 private:
  /// 0 where it was not run.
  [[nodiscard]] double rate(const Scene& scene, const std::string& engine, const char* name) const {
    const auto run = rates_.find(scene.name + engine);
    return run == rates_.end() ? 0 : run->second.at(name);
  }

  std::map<std::string, std::map<std::string, double>> rates_;
};

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const auto add = [](const std::string& name, const auto& run) {
    return benchmark::RegisterBenchmark(name.c_str(), run)
        ->Unit(benchmark::kMillisecond)
        ->MinTime(0.2)
        ->Repetitions(3)
        ->DisplayAggregatesOnly(false);
  };
  for (const Scene& scene : scenes()) {
    add(std::string(scene.name) + kByTwo, [&](benchmark::State& state) {
      trace_by_two(state, scene);
    })->UseManualTime();
    for (const EngineKind& kind : engine_kinds())
      add(std::string(scene.name) + "/" + kind.name,
          [&](benchmark::State& state) { trace(state, scene, kind); });
  }
  BestRates rates;
  benchmark::RunSpecifiedBenchmarks(&rates);
  rates.print_ratios();
}
