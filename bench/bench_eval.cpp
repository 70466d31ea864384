// SPDX-License-Identifier: GPL-3.0-or-later
// Eq. 12 over the paper's map, 3,141,521 windows of 35 x 35 bins and discs of 35 bins, one thread: a
// selection in each window, on some rows only, against the shared tails. The ratios of their rates come last.
// The whole evaluation (metrics only) of maps of 501 to 4001 bins on a side shows how its time grows;
// verdicts alone, of 2001 bins on a side with limits that most footprints keep, that half of them keep, or
// none.
//   bench_eval [dem.h5] [--benchmark_filter=noise ...]
// With a DEM of 2001 x 2001 bins of 0.05 m, that DEM's three axes instead of the synthetic maps.
// Times move with whatever else the machine does: each method's best of three repetitions counts.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "base/raster/region.h"
#include "chain/evaluation/accuracy.h"
#include "chain/evaluation/evaluate.h"
#include "chain/evaluation/judge/verdict.h"
#include "chain/evaluation/quantile/window_quantile.h"
#include "store/files/evaluation_file.h"

namespace landfall {
namespace {

const Footprint kSquare = Footprint::square(17);
const Footprint kDisc = Footprint::disc(289);
constexpr std::int64_t kRowsPerSelection = 60;  // one row in so many

GridSpec paper_grid() { return {0.05, -1000, -1000, 2001, 2001}; }

struct Scene {
  std::string name;
  std::function<Grid<double>()> error;
};

template <class ErrorAt>
Grid<double> map_of(ErrorAt error_at) {
  Grid<double> error(paper_grid());
  const GridSpec& spec = error.spec();
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      error.at({row, col}) = error_at(spec.x(col), spec.y(row), spec.index({row, col}));
  return error;
}

constexpr double kSigma_m = 0.0333;
const RandomField kNormal(5, RandomStream::range_noise);
const RandomField kUniform(5, RandomStream::dropout);

Grid<double> noise() {
  return map_of([](double, double, std::size_t i) {
    return kUniform.uniform(i) < 0.04 ? std::numeric_limits<double>::quiet_NaN()
                                      : kSigma_m * kNormal.normal(i);
  });
}

/// Ten cones of 3 m radius on a plane: on a flank, the slope times the place within the bin.
double cone_error_m(double x, double y, std::size_t i) {
  for (int cone = 0; cone < 10; ++cone) {
    const double azimuth = 0.2 * std::numbers::pi * cone;
    if (std::hypot(x - 21.1 * std::cos(azimuth), y - 21.1 * std::sin(azimuth)) < 3)
      return 10.0 / 3 * 0.05 * (kUniform.uniform(i) - 0.5);
  }
  return 0;
}

Grid<double> cones() { return map_of(cone_error_m); }

Grid<double> noisy_cones() {
  return map_of([](double x, double y, std::size_t i) {
    return cone_error_m(x, y, i) + 0.01 * kSigma_m * kNormal.normal(i);
  });
}

/// Long waves and a trend, as a velocity error leaves them on relief.
Grid<double> relief() {
  return map_of([](double x, double y, std::size_t i) {
    double error = 0.002 * y + 0.002 * kNormal.normal(i);
    for (int octave = 0; octave < 6; ++octave) {
      const double wave = 2 * std::numbers::pi / 50 * std::exp2(octave);
      error += 0.05 * std::exp2(-octave) * std::sin(wave * x + octave) * std::sin(wave * y - 2 * octave);
    }
    return error;
  });
}

std::vector<Scene> scenes_of(const DemLayers& dem) {
  if (!dem.truth || !(dem.z_est.spec() == paper_grid())) return {};
  std::vector<Scene> scenes;
  for (const auto& [name, axis] : {std::pair{"x", Axis::x}, std::pair{"y", Axis::y}, std::pair{"z", Axis::z}})
    scenes.push_back({name, [&dem, a = axis] {
                        return error_of(a,
                                        a == Axis::x   ? dem.truth->x
                                        : a == Axis::y ? dem.truth->y
                                                       : dem.truth->z,
                                        dem.z_est);
                      }});
  return scenes;
}

struct Method {
  const char* name;
  std::int64_t row_step;
  const Footprint& footprint;
  Grid<double> (*run)(const WindowQuantileInput&);
};

const Method kMethods[] = {
    {"selection", kRowsPerSelection, kSquare,
     [](const WindowQuantileInput& in) { return window_quantile_naive(in); }},
    {"tails", 1, kSquare, [](const WindowQuantileInput& in) { return window_quantile(in); }},
    {"disc_selection", kRowsPerSelection, kDisc,
     [](const WindowQuantileInput& in) { return window_quantile_naive(in); }},
    {"disc_tails", 1, kDisc, [](const WindowQuantileInput& in) { return window_quantile(in); }}};

void measure(benchmark::State& state, const Scene& scene, const Method& method) {
  const ThreadLimit one_thread(1);
  const Grid<double> error = scene.error();
  const WindowMeans windows = window_means(error, method.footprint);
  BinMask region = circular_region(error.spec(), 50);
  for (std::int64_t row = 0; row < error.spec().rows; ++row)
    if (row % method.row_step != 0) std::ranges::fill(region.row(row), std::int8_t{0});
  const WindowQuantileInput input{
      .error = error, .windows = windows, .footprint = method.footprint, .region = region, .quantile = 0.95};
  for (auto _ : state) benchmark::DoNotOptimize(method.run(input).values().data());
  state.SetItemsProcessed(count_set(region) * state.iterations());
}

/// A DEM of noise.
DemLayers noisy_dem(std::int64_t half) {
  const GridSpec spec{0.05, -half, -half, 2 * half + 1, 2 * half + 1};
  DemLayers dem{.z_est = Grid<double>(spec),
                .truth = TrueLayers{Grid<double>(spec), Grid<double>(spec), Grid<double>(spec)}};
  for (std::int64_t row = 0; row < spec.rows; ++row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const std::size_t i = spec.index({row, col});
      dem.truth->x.values()[i] = spec.x(col) + 0.01 * kNormal.normal(i, 1);
      dem.truth->y.values()[i] = spec.y(row) + 0.01 * kNormal.normal(i, 2);
      dem.truth->z.values()[i] = kSigma_m * kNormal.normal(i);
    }
  }
  return dem;
}

/// The region is as large as fits.
void measure_evaluation(benchmark::State& state) {
  const DemLayers dem = noisy_dem(state.range(0));
  EvaluationParameters parameters;
  parameters.region_radius_m = 0.05 * static_cast<double>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(evaluate(dem, parameters).metrics.pass);
  state.SetItemsProcessed(static_cast<std::int64_t>(dem.z_est.spec().size()) * state.iterations());
}

/// The limit of z in millimetres: its 95th percentile in a footprint is 65 mm.
void measure_verdict(benchmark::State& state) {
  const DemLayers dem = noisy_dem(state.range(0));
  EvaluationParameters parameters;
  parameters.region_radius_m = 0.05 * static_cast<double>(state.range(0));
  parameters.limits.relative_z_m = 0.001 * static_cast<double>(state.range(1));
  const BinMask region = judged_region(parameters, dem.z_est.spec(), nullptr);
  for (auto _ : state) benchmark::DoNotOptimize(decide(dem, region, parameters).metrics.pass);
  state.SetItemsProcessed(static_cast<std::int64_t>(dem.z_est.spec().size()) * state.iterations());
}

/// Keeps each benchmark's best rate beside what the console shows.
class BestRates : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      const auto rate = run.counters.find("items_per_second");
      if (run.run_type != Run::RT_Iteration || rate == run.counters.end()) continue;
      double& best = rates_[run.run_name.function_name];
      best = std::max(best, static_cast<double>(rate->second));
    }
  }

  /// `prefix` chooses the footprint: "" or "disc_".
  void print_ratios(const std::vector<Scene>& scenes, const std::string& prefix) const {
    double selection_s = 0;
    double tails_s = 0;
    for (const Scene& scene : scenes) {
      const auto selection = rates_.find(scene.name + "/" + prefix + "selection");
      const auto tails = rates_.find(scene.name + "/" + prefix + "tails");
      if (selection == rates_.end() || tails == rates_.end()) continue;
      selection_s += 1 / selection->second;
      tails_s += 1 / tails->second;
      std::cout << prefix << scene.name << ": selection " << 1e9 / selection->second << " ns, tails "
                << 1e9 / tails->second << " ns per window, " << tails->second / selection->second << " x\n";
    }
    if (tails_s > 0) std::cout << prefix << "all of them: " << selection_s / tails_s << " x\n";
  }

 private:
  std::map<std::string, double> rates_;
};

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  benchmark::Initialize(&argc, argv);
  DemInput dem;
  if (argc > 1) dem = read_dem(argv[1]);
  const std::vector<Scene> scenes =
      argc > 1 ? scenes_of(dem.layers)
               : std::vector<Scene>{
                     {"noise", noise}, {"cones", cones}, {"noisy_cones", noisy_cones}, {"relief", relief}};
  if (scenes.empty()) {
    std::cerr << "bench_eval: " << argv[1] << ": not a DEM with truth of the paper's size\n";
    return 2;
  }
  for (const Scene& scene : scenes)
    for (const Method& method : kMethods)
      benchmark::RegisterBenchmark((scene.name + "/" + method.name).c_str(),
                                   [&](benchmark::State& state) { measure(state, scene, method); })
          ->Unit(benchmark::kMillisecond)
          ->MinTime(0.1)
          ->Repetitions(3);
  benchmark::RegisterBenchmark("evaluation", measure_evaluation)
      ->Arg(250)
      ->Arg(500)
      ->Arg(1000)
      ->Arg(2000)
      ->Unit(benchmark::kMillisecond)
      ->UseRealTime();
  benchmark::RegisterBenchmark("verdict", measure_verdict)
      ->Args({1000, 100})
      ->Args({1000, 65})
      ->Args({1000, 30})
      ->Unit(benchmark::kMillisecond)
      ->MeasureProcessCPUTime();
  BestRates rates;
  benchmark::RunSpecifiedBenchmarks(&rates);
  for (const char* const prefix : {"", "disc_"}) rates.print_ratios(scenes, prefix);
}
