// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/devices.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "cli/print.h"
#include "opencl/opencl_engine.h"
#include "ray/heightfield_engine.h"

namespace landfall::cli {
namespace {

constexpr int kPixels = 18;  // along each axis
constexpr std::size_t kPulseRays = std::size_t{kPixels} * kPixels;

/// Hills from 50 m down to 0.4 m of wavelength.
std::shared_ptr<const TriangulatedGrid> relief() {
  Grid<double> nodes(GridSpec::centered(50, 0.2));
  const GridSpec& spec = nodes.spec();
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col)
      for (int octave = 0; octave < 8; ++octave) {
        const double wave = 0.125 * std::exp2(octave);
        nodes.at({row, col}) += 2 * std::exp2(-octave) * std::sin(wave * spec.x(col) + octave) *
                                std::sin(wave * spec.y(row) - 2 * octave);
      }
  return std::make_shared<const TriangulatedGrid>(std::move(nodes));
}

/// A pulse of the paper's detector at this place of the ground, from 500 m above the centre.
void append_pulse(double x_m, double y_m, std::vector<Ray>& rays) {
  constexpr double kPixel_m = 500 / 11250.0;
  const Point<DemFrame> origin{{0, 0, 500}};
  for (int row = 0; row < kPixels; ++row)
    for (int col = 0; col < kPixels; ++col) {
      const Eigen::Vector3d target(x_m + kPixel_m * (col - 8.5), y_m + kPixel_m * (row - 8.5), 0);
      rays.push_back({origin, Direction<DemFrame>::of({target - origin.v})});
    }
}

/// 32 x 32 pulses on 80 m x 80 m.
std::vector<Ray> pulses() {
  constexpr int kPulses = 32;
  std::vector<Ray> rays;
  for (int row = 0; row < kPulses; ++row)
    for (int col = 0; col < kPulses; ++col) append_pulse(2.5 * (col - 15.3), 2.5 * (row - 15.6), rays);
  return rays;
}

double rays_per_s(std::size_t rays, const std::function<void()>& trace) {
  double best_s = std::numeric_limits<double>::infinity();
  trace();  // compiles, allocates and touches memory
  for (int i = 0; i < 3; ++i) {
    const auto start = std::chrono::steady_clock::now();
    trace();
    best_s =
        std::min(best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return static_cast<double>(rays) / best_s;
}

bool same_bits(std::span<const double> a, std::span<const double> b) {
  return std::ranges::equal(a, b, [](double x, double y) {
    return (std::isnan(x) && std::isnan(y)) || (x == y && std::signbit(x) == std::signbit(y));
  });
}

nlohmann::ordered_json described(const OpenClDevice& device) {
  return {
      {"name", device.name},       {"platform", device.platform},         {"driver", device.driver},
      {"kind", device.kind},       {"memory_bytes", device.memory_bytes}, {"has_doubles", device.has_doubles},
      {"problem", device.problem}, {"is_usable", device.is_usable()}};
}

std::string device_line(const char* name, const std::string& value) {
  return print("  %-9s ", name) + value + "\n";
}

std::string use_text(const nlohmann::ordered_json& device) {
  if (!device.at("is_usable")) return "none: " + device.at("problem").get<std::string>();
  return device.at("same_ranges") ? "ranges equal the CPU's bit for bit"
                                  : "none: its ranges differ from the CPU's";
}

std::string speed_text(const nlohmann::ordered_json& measured) {
  return print("%.3g million rays/s", measured.at("rays_per_s").get<double>() / 1e6);
}

}  // namespace

nlohmann::ordered_json measure_devices(const ProgressCallback& progress) {
  const std::vector<OpenClDevice> devices = opencl_devices();
  if (devices.empty()) static_cast<void>(default_device(devices));  // says so
  const auto terrain = relief();
  const std::vector<Ray> rays = pulses();
  std::vector<double> expected(rays.size());
  const auto on_cpu = make_heightfield_engine(terrain);
  const double cpu_rays_per_s = rays_per_s(rays.size(), [&] {
    parallel_for(rays.size(), kPulseRays, [&](std::size_t begin, std::size_t end) {
      on_cpu->first_hits(std::span(rays).subspan(begin, end - begin),
                         std::span(expected).subspan(begin, end - begin));
    });
  });
  nlohmann::ordered_json measured = {{"devices", nlohmann::ordered_json::array()},
                                     {"cpu", {{"threads", thread_count()}, {"rays_per_s", cpu_rays_per_s}}}};
  for (std::size_t i = 0; i < devices.size(); ++i) {
    report(progress, static_cast<double>(i) / static_cast<double>(devices.size()));
    nlohmann::ordered_json device = described(devices[i]);
    if (devices[i].is_usable()) {
      std::vector<double> ranges(rays.size());
      const auto engine = make_opencl_engine(terrain, {.device = i});
      device["rays_per_s"] = rays_per_s(rays.size(), [&] { engine->first_hits(rays, ranges); });
      device["same_ranges"] = same_bits(ranges, expected);
    }
    measured.at("devices").push_back(std::move(device));
  }
  report(progress, 1);
  return measured;
}

std::string devices_text(const nlohmann::ordered_json& measured) {
  std::string text;
  for (const nlohmann::ordered_json& device : measured.at("devices")) {
    text += device.at("name").get<std::string>() + "\n";
    text += device_line("kind", device.at("kind"));
    text += device_line(
        "driver", device.at("platform").get<std::string>() + " " + device.at("driver").get<std::string>());
    text += device_line("memory", print("%.3g GB", device.at("memory_bytes").get<double>() / 1e9));
    text += device_line("doubles", device.at("has_doubles") ? "yes" : "no");
    text += device_line("use", use_text(device));
    if (device.contains("rays_per_s")) text += device_line("speed", speed_text(device));
  }
  const nlohmann::ordered_json& cpu = measured.at("cpu");
  text += "this CPU, engine heightfield\n";
  text += device_line("threads", std::to_string(cpu.at("threads").get<std::size_t>()));
  return text + device_line("speed", speed_text(cpu));
}

}  // namespace landfall::cli
