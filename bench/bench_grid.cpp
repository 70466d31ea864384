// SPDX-License-Identifier: GPL-3.0-or-later
// Binning against the floor that memory sets: the bytes that must move, over the bandwidths measured in the
// same run. Time is wall time, CPU that of all threads.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <vector>

#include "base/core/parallel.h"
#include "base/memory/zeroed_memory.h"
#include "chain/gridding/method.h"
#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {
namespace {

constexpr std::size_t kPaperPoints = 12'960'000;
constexpr std::size_t kBatch = std::size_t{1} << 18U;  // as regrid

/// Returns as a scanner makes them: 200 lines of 200 pulses of 18 x 18 pixels, 5 cm apart on the ground.
struct Scan {
  std::array<std::vector<double>, 7> columns;

  explicit Scan(bool in_order) {
    for (auto& column : columns) column.resize(kPaperPoints);
    std::vector<std::uint32_t> order(kPaperPoints);
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<std::uint32_t>(i);
    std::mt19937_64 random(1);
    if (!in_order) std::ranges::shuffle(order, random);
    for (std::size_t i = 0; i < order.size(); ++i) put(i, order[i]);
  }
  void put(std::size_t i, std::size_t point) {
    const auto pulse = static_cast<double>(point / 324);
    const auto pixel = static_cast<double>(point % 324);
    const double x = -50 + 0.5 * std::fmod(pulse, 200) + 0.0503 * std::fmod(pixel, 18) - 0.4;
    const double y = 50 - 0.5 * std::floor(pulse / 200) + 0.0497 * std::floor(pixel / 18) - 0.4;
    const std::array<double, 7> values = {x, y, 0.1 * x, x + 0.01, y - 0.01, 0.1 * x, pulse / 20000};
    for (std::size_t c = 0; c < 7; ++c) columns[c][i] = values[c];
  }
  [[nodiscard]] GridPoints points() const {
    GridPoints::Columns views;
    std::ranges::copy(columns, views.begin());
    return GridPoints::of(views);
  }
};

const Scan& scan(bool in_order) {
  static std::map<bool, std::unique_ptr<Scan>> scans;
  auto& scan = scans[in_order];
  if (!scan) scan = std::make_unique<Scan>(in_order);
  return *scan;
}

/// Bytes per second to and from memory: where they are only read, and where they are changed in place, each
/// counted once in both directions.
struct Bandwidth {
  double read;
  double update;
};

/// The bandwidth of half a gigabyte, the best of nine. All of it has been written before: pages never written
/// are one and the same, which the cache holds.
Bandwidth measured_bandwidth() {
  constexpr std::size_t kSize = std::size_t{1} << 26U;
  ZeroedArray<std::uint64_t> numbers(kSize);
  std::ranges::fill(numbers.values(), 1);
  const auto bytes_per_second = [&](const auto& work) {
    double best_s = 1e9;
    for (int i = 0; i < 9; ++i) {
      const auto start = std::chrono::steady_clock::now();
      parallel_for(kSize, kSize / 64, [&](std::size_t begin, std::size_t end) {
        work(numbers.values().subspan(begin, end - begin));
      });
      const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
      best_s = std::min(best_s, time.count());
    }
    return kSize * sizeof(std::uint64_t) / best_s;
  };
  const double read = bytes_per_second([](std::span<const std::uint64_t> some) {
    benchmark::DoNotOptimize(std::accumulate(some.begin(), some.end(), std::uint64_t{0}));
  });
  const double update = 2 * bytes_per_second([](std::span<std::uint64_t> some) {
                          for (std::uint64_t& number : some) ++number;
                        });
  return {read, update};
}

Bandwidth bandwidth(std::size_t threads) {
  static std::map<std::size_t, Bandwidth> known;
  if (!known.contains(threads)) known[threads] = measured_bandwidth();
  return known[threads];
}

/// The time in which memory could do it: the columns are read; in order each bin comes from memory once and
/// returns once, in random order two cache lines do so per return.
double floor_s(std::size_t points, std::size_t bins, bool in_order, Bandwidth bandwidth) {
  const double sums =
      in_order ? sizeof(BinSums) * static_cast<double>(bins) : 128 * static_cast<double>(points);
  return 56 * static_cast<double>(points) / bandwidth.read + 2 * sums / bandwidth.update;
}

/// One run: the scan `repeats` times over a fresh map.
void run(benchmark::State& state, Method method, bool in_order, std::int64_t repeats, double resolution_m) {
  const ThreadLimit limit(static_cast<std::size_t>(state.range(0)));
  const GridPoints points = scan(in_order).points();
  const GridSpec spec = GridSpec::centered(50, resolution_m);
  for (auto _ : state) {
    state.PauseTiming();
    std::unique_ptr<Accumulator> bins = make_accumulator(method, spec);
    bins->add(points);  // the map's pages
    state.ResumeTiming();
    for (std::int64_t i = 0; i < repeats; ++i)
      for (std::size_t begin = 0; begin < points.size(); begin += kBatch)
        bins->add(points.subset(begin, std::min(kBatch, points.size() - begin)));
    state.PauseTiming();
    bins.reset();
    state.ResumeTiming();
  }
  const double count = static_cast<double>(repeats) * static_cast<double>(kPaperPoints);
  const Bandwidth memory = bandwidth(static_cast<std::size_t>(state.range(0)));
  const double min_s = static_cast<double>(repeats) * floor_s(kPaperPoints, spec.size(), in_order, memory);
  state.counters["points/s"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["read_GB/s"] = memory.read * 1e-9;
  state.counters["update_GB/s"] = memory.update * 1e-9;
  state.counters["floor_ms"] = min_s * 1e3;
  // Inverted: Google Benchmark divides a rate by the time.
  state.counters["of_floor"] = benchmark::Counter(min_s, benchmark::Counter::kIsIterationInvariantRate);
}

void register_all() {
  const auto add = [](const std::string& name, auto... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { run(state, arguments...); })
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->Unit(benchmark::kMillisecond)
        ->MeasureProcessCPUTime()
        ->UseRealTime();
  };
  using enum Method;
  add("scan_order", bilinear_nearest, true, 1, 0.05);
  add("random_order", bilinear_nearest, false, 1, 0.05);
  add("scan_order/3x_points", bilinear_nearest, true, 3, 0.05);
  add("scan_order/10x_points", bilinear_nearest, true, 10, 0.05);
  add("scan_order/quarter_of_bins", bilinear_nearest, true, 1, 0.1);
  add("scan_order/4x_bins", bilinear_nearest, true, 1, 0.025);
  add("scan_order/bilinear4", bilinear4, true, 1, 0.05);
  add("scan_order/mean", mean, true, 1, 0.05);
  add("scan_order/min", min, true, 1, 0.05);
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  landfall::register_all();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
