// SPDX-License-Identifier: GPL-3.0-or-later
// Binning against the floor that memory sets: the bytes that must move, over the bandwidth measured in the
// same run.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <random>
#include <vector>

#include "base/parallel.h"
#include "base/zeroed_memory.h"
#include "gridding/bin_accumulator.h"
#include "gridding/method.h"

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
    return {columns[0], columns[1], columns[2], columns[3], columns[4], columns[5], columns[6]};
  }
};

const Scan& scan(bool in_order) {
  static std::map<bool, std::unique_ptr<Scan>> scans;
  auto& scan = scans[in_order];
  if (!scan) scan = std::make_unique<Scan>(in_order);
  return *scan;
}

/// Bytes read and written per second by a copy of half a gigabyte, the best of five.
double bandwidth(std::size_t threads) {
  static std::map<std::size_t, double> known;
  if (known.contains(threads)) return known[threads];
  constexpr std::size_t kSize = std::size_t{1} << 25U;
  ZeroedArray<double> from(kSize);
  ZeroedArray<double> to(kSize);
  double best_s = 1e9;
  for (int i = 0; i < 6; ++i) {
    const auto start = std::chrono::steady_clock::now();
    parallel_for(kSize, kSize / 64, [&](std::size_t begin, std::size_t end) {
      std::memcpy(&to[begin], &from[begin], (end - begin) * sizeof(double));
    });
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    if (i > 0) best_s = std::min(best_s, time.count());
  }
  return known[threads] = 2 * kSize * sizeof(double) / best_s;
}

/// In order each bin comes from memory once and returns once; in random order two cache lines do so per
/// return.
double bytes_to_move(std::size_t points, std::size_t bins, bool in_order) {
  const double columns = 56 * static_cast<double>(points);
  return columns +
         (in_order ? 2 * sizeof(BinSums) * static_cast<double>(bins) : 2 * 128 * static_cast<double>(points));
}

/// One run: the scan `repeats` times over a fresh map.
void run(benchmark::State& state, Method method, bool in_order, std::int64_t repeats, double resolution_m) {
  const ThreadLimit limit(static_cast<std::size_t>(state.range(0)));
  const GridPoints points = scan(in_order).points();
  const GridSpec spec = GridSpec::centered(50, resolution_m);
  for (auto _ : state) {
    state.PauseTiming();
    std::unique_ptr<Accumulator> bins = make_accumulator(method, spec);
    bins->add(points, 0);  // the map's pages
    state.ResumeTiming();
    for (std::int64_t i = 0; i < repeats; ++i)
      for (std::size_t begin = 0; begin < points.size(); begin += kBatch)
        bins->add(points.subset(begin, std::min(kBatch, points.size() - begin)), 0);
    state.PauseTiming();
    bins.reset();
    state.ResumeTiming();
  }
  const double count = static_cast<double>(repeats) * static_cast<double>(kPaperPoints);
  const double floor_s = static_cast<double>(repeats) * bytes_to_move(kPaperPoints, spec.size(), in_order) /
                         bandwidth(static_cast<std::size_t>(state.range(0)));
  state.counters["points/s"] = benchmark::Counter(count, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["floor_ms"] = floor_s * 1e3;
  // Inverted: Google Benchmark divides a rate by the time.
  state.counters["of_floor"] = benchmark::Counter(floor_s, benchmark::Counter::kIsIterationInvariantRate);
}

void register_all() {
  const auto add = [](const std::string& name, auto... arguments) {
    benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) { run(state, arguments...); })
        ->ArgName("threads")
        ->Arg(1)
        ->Arg(2)
        ->Unit(benchmark::kMillisecond)
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
