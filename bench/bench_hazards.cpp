// SPDX-License-Identifier: GPL-3.0-or-later
// Slope and roughness of the methods of hazard-map with the default lander (27 yaws, 901 bins under the body)
// on maps of 1001 x 1001 bins of 0.05 m, one thread. Methods contact and plane are compared with the obvious
// loops over a few places, compiled with -O3; the ratios of their rates come last, and the largest difference
// of the results.
//   bench_hazards [--benchmark_filter=rocks ...]
// The CPU time of the best of three repetitions counts.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/random.h"
#include "chain/hazards/measures.h"

namespace landfall {
namespace {

constexpr std::int64_t kEvery = 16;  ///< the obvious loops measure one place in so many rows and columns
const GridSpec kSpec = GridSpec::centered(25, 0.05);

Grid<double> terrain(const std::function<double(double x, double y)>& height_m) {
  const RandomField noise(5, RandomStream::range_noise);
  Grid<double> z(kSpec);
  for (std::int64_t row = 0; row < kSpec.rows; ++row)
    for (std::int64_t col = 0; col < kSpec.cols; ++col)
      z.at({row, col}) = height_m(kSpec.x(col), kSpec.y(row)) + 0.01 * noise.normal(kSpec.index({row, col}));
  return z;
}

Grid<double> noise() {
  return terrain([](double, double) { return 0; });
}

/// 400 hemispheres of 0.1 to 0.5 m on long waves.
Grid<double> rocks() {
  Grid<double> z = terrain([](double x, double y) { return 0.5 * std::sin(0.3 * x) * std::cos(0.2 * y); });
  const RandomField random(7, RandomStream::dropout);
  for (std::uint64_t rock = 0; rock < 400; ++rock) {
    const double radius_m = 0.1 + 0.4 * random.uniform(rock, 0);
    const double x_m = 50 * random.uniform(rock, 1) - 25;
    const double y_m = 50 * random.uniform(rock, 2) - 25;
    for (std::int64_t row = 0; row < kSpec.rows; ++row)
      for (std::int64_t col = 0; col < kSpec.cols; ++col) {
        const double d = std::hypot(kSpec.x(col) - x_m, kSpec.y(row) - y_m);
        if (d < radius_m) z.at({row, col}) += std::sqrt(radius_m * radius_m - d * d);
      }
  }
  return z;
}

struct Scene {
  const char* name;
  Grid<double> (*make)();
};
constexpr Scene kScenes[] = {{"noise", noise}, {"rocks", rocks}};

std::vector<BinOffset> bins_of(const Footprint& footprint) {
  std::vector<BinOffset> bins;
  for (std::int64_t row = -footprint.half_bins(); row <= footprint.half_bins(); ++row)
    for (std::int64_t col = -footprint.half_width(row); col <= footprint.half_width(row); ++col)
      bins.push_back({row, col});
  return bins;
}

/// The definitions of docs/user/hazard-map.md as loops over yaws, pads, planes and bins.
class ObviousLoops {
 public:
  ObviousLoops(const Grid<double>& z, const LanderStencil& lander)
      : z_(z), lander_(lander), pad_(bins_of(lander.pad)), body_(bins_of(lander.body)) {}

  struct Measures {
    double slope_deg = 0;
    double roughness_m = -std::numeric_limits<double>::infinity();
  };

  [[nodiscard]] Measures contact(BinIndex place) const {
    Measures maximum;
    for (const PadOffsets& pads : lander_.yaws) {
      std::array<double, 4> height;
      for (std::size_t leg = 0; leg < 4; ++leg) height[leg] = pad_height(place, pads[leg]);
      const std::size_t first = height[0] + height[2] >= height[1] + height[3] ? 0 : 1;
      for (const std::size_t third : {first + 1, (first + 3) % 4})
        stand({pads[first], height[first]}, {pads[first + 2], height[first + 2]},
              {pads[third], height[third]}, place, maximum);
    }
    return maximum;
  }

  [[nodiscard]] Measures plane(BinIndex place) const {
    double n = 0, x = 0, y = 0, z = 0, xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
    for (const BinOffset& bin : body_) {
      const auto c = static_cast<double>(bin.cols);
      const auto r = static_cast<double>(bin.rows);
      const double h = at(place, bin);
      n += 1, x += c, y += r, z += h, xx += c * c, xy += c * r, yy += r * r, xz += c * h, yz += r * h;
    }
    const double a = xx - x * x / n, b = xy - x * y / n, d = yy - y * y / n;
    const double p = xz - x * z / n, q = yz - y * z / n;
    const double east = (p * d - q * b) / (a * d - b * b);
    const double north = (q * a - p * b) / (a * d - b * b);
    const double height = (z - east * x - north * y) / n;
    double maximum = 0;
    for (const BinOffset& bin : body_)
      maximum = std::max(maximum, std::abs(at(place, bin) - (height + east * static_cast<double>(bin.cols) +
                                                             north * static_cast<double>(bin.rows))));
    const double gradient = std::hypot(east, north) / lander_.resolution_m;
    return {slope_deg(gradient), maximum / std::hypot(1, gradient)};
  }

 private:
  struct Pad {
    BinOffset bin;
    double height;
  };

  [[nodiscard]] double at(BinIndex place, const BinOffset& bin) const {
    return z_.at({place.row + bin.rows, place.col + bin.cols});
  }
  [[nodiscard]] double pad_height(BinIndex place, const BinOffset& centre) const {
    double highest = -std::numeric_limits<double>::infinity();
    for (const BinOffset& bin : pad_)
      highest = std::max(highest, at(place, {centre.rows + bin.rows, centre.cols + bin.cols}));
    return highest;
  }

  void stand(const Pad& p, const Pad& q, const Pad& r, BinIndex place, Measures& maximum) const {
    const auto x = [&](const Pad& pad) { return static_cast<double>(pad.bin.cols - p.bin.cols); };
    const auto y = [&](const Pad& pad) { return static_cast<double>(pad.bin.rows - p.bin.rows); };
    const double determinant = x(q) * y(r) - x(r) * y(q);
    const double east = ((q.height - p.height) * y(r) - (r.height - p.height) * y(q)) / determinant;
    const double north = ((r.height - p.height) * x(q) - (q.height - p.height) * x(r)) / determinant;
    const double height =
        p.height - east * static_cast<double>(p.bin.cols) - north * static_cast<double>(p.bin.rows);
    const double gradient = std::hypot(east, north) / lander_.resolution_m;
    maximum.slope_deg = std::max(maximum.slope_deg, slope_deg(gradient));
    double highest = -std::numeric_limits<double>::infinity();
    for (const BinOffset& bin : body_)
      highest = std::max(highest, at(place, bin) - (height + east * static_cast<double>(bin.cols) +
                                                    north * static_cast<double>(bin.rows)));
    maximum.roughness_m = std::max(maximum.roughness_m, highest / std::hypot(1, gradient));
  }

  const Grid<double>& z_;
  const LanderStencil& lander_;
  std::vector<BinOffset> pad_, body_;
};

/// The places at which all bins lie on the map.
std::vector<BinIndex> places_of(const PlaceMeasures& measured, std::int64_t every) {
  std::vector<BinIndex> places;
  for (std::int64_t row = 0; row < kSpec.rows; row += every)
    for (std::int64_t col = 0; col < kSpec.cols; col += every)
      if (!std::isnan(measured.slope_deg.at({row, col}))) places.push_back({row, col});
  return places;
}

using Measure = std::function<PlaceMeasures(const Grid<double>&, const LanderStencil&, const BinMask&)>;
using Obvious = ObviousLoops::Measures (ObviousLoops::*)(BinIndex) const;

struct Method {
  const char* name;
  Measure measure;
  Obvious obvious = nullptr;
};

const std::vector<Method>& methods() {
  static const std::vector<Method> all = {
      {"contact",
       [](const auto& z, const auto& lander, const auto& places) {
         return measure_contact(z, lander, places);
       },
       &ObviousLoops::contact},
      {"plane",
       [](const auto& z, const auto& lander, const auto& places) { return measure_plane(z, lander, places); },
       &ObviousLoops::plane},
      {"range_difference",
       [](const auto& z, const auto& lander, const auto& places) {
         return measure_range_difference(
             z, {lander.body.half_bins(), rock_half_bins(0.3, kSpec.resolution_m)}, places);
       }},
      {"lmeds", [](const auto& z, const auto& lander, const auto& places) {
         return measure_lmeds(z, lander, places);
       }}};
  return all;
}

const LanderStencil& default_lander() {
  static const LanderStencil lander({}, kSpec.resolution_m);
  return lander;
}

void time_method(benchmark::State& state, const Scene& scene, const Method& method) {
  const ThreadLimit one_thread(1);
  const Grid<double> z = scene.make();
  const BinMask everywhere(kSpec, 1);
  std::size_t places = 0;
  for (auto _ : state) {
    const PlaceMeasures measured = method.measure(z, default_lander(), everywhere);
    state.PauseTiming();
    places = places_of(measured, 1).size();
    state.ResumeTiming();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(places) * state.iterations());
}

std::map<std::string, double>& differences() {
  static std::map<std::string, double> all;
  return all;
}

void time_obvious(benchmark::State& state, const Scene& scene, const Method& method) {
  const ThreadLimit one_thread(1);
  const Grid<double> z = scene.make();
  const PlaceMeasures fast = method.measure(z, default_lander(), BinMask(kSpec, 1));
  const std::vector<BinIndex> places = places_of(fast, kEvery);
  const ObviousLoops loops(z, default_lander());
  double& difference = differences()[std::string(scene.name) + "/" + method.name];
  for (auto _ : state)
    for (const BinIndex place : places) {
      const ObviousLoops::Measures slow = (loops.*method.obvious)(place);
      difference = std::max({difference, std::abs(slow.slope_deg - fast.slope_deg.at(place)),
                             std::abs(slow.roughness_m - fast.roughness_m.at(place))});
    }
  state.SetItemsProcessed(static_cast<std::int64_t>(places.size()) * state.iterations());
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

  void print_ratios() const {
    for (const auto& [name, rate] : rates_) {
      if (name.ends_with("/obvious")) continue;
      std::cout << name << ": " << 1e9 / rate << " ns per place";
      const auto obvious = rates_.find(name + "/obvious");
      if (obvious != rates_.end())
        std::cout << ", the obvious loops " << 1e9 / obvious->second << " ns, " << rate / obvious->second
                  << " x; largest difference " << differences()[name];
      std::cout << "\n";
    }
  }

 private:
  std::map<std::string, double> rates_;
};

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  using namespace landfall;
  benchmark::Initialize(&argc, argv);
  for (const Scene& scene : kScenes)
    for (const Method& method : methods()) {
      const std::string name = std::string(scene.name) + "/" + method.name;
      const auto add = [&](const std::string& full_name, const auto& time) {
        benchmark::RegisterBenchmark(
            full_name.c_str(),
            [&scene, &method, time](benchmark::State& state) { time(state, scene, method); })
            ->Unit(benchmark::kMillisecond)
            ->MinTime(0.1)
            ->Repetitions(3);
      };
      add(name, time_method);
      if (method.obvious != nullptr) add(name + "/obvious", time_obvious);
    }
  BestRates rates;
  benchmark::RunSpecifiedBenchmarks(&rates);
  rates.print_ratios();
}
