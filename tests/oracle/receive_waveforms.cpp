// SPDX-License-Identifier: GPL-3.0-or-later
// Waveforms through lib/chain/lidar/receiver, for tests/oracle/real_waveforms_test.py.
//
// usage: receive_waveforms FWHM_NS THRESHOLD FRACTION < waveforms > times
//
// A line of the input is one waveform, w(t) = sum_j e_j exp(-(t - t_j)^2/(2 sigma^2)), as t_1 e_1 t_2 e_2 ...
// (nanoseconds, counts). A line of the output: its maximum, and what the receivers leading_edge,
// constant_fraction, peak and centroid report without noise (ns; nan: nothing). The offset that
// constant_fraction adds for a pulse of FWHM_NS is removed: it reports its crossing.
#include <array>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "base/numerics/light.h"
#include "chain/lidar/receiver/receiver.h"

namespace landfall {
namespace {

constexpr double kNs = 1e-9;

struct Waveform {
  std::vector<double> ranges_m, counts;
};

Waveform parsed(const std::string& line) {
  std::istringstream text(line);
  Waveform waveform;
  double time_ns = 0;
  double counts = 0;
  while (text >> time_ns >> counts) {
    waveform.ranges_m.push_back(range_of_time_m(kNs * time_ns));
    waveform.counts.push_back(counts);
  }
  return waveform;
}

double ns_of(double range_m) { return range_m / range_of_time_m(kNs); }

class Bench {
 public:
  explicit Bench(const ReceiverParameters& parameters) : receiver_(parameters, 0) {}

  struct Heard {
    double height, time_ns;
  };
  [[nodiscard]] Heard hear(Waveform waveform) const {
    Waveforms waveforms;
    waveforms.clear(waveform.counts.size());
    receiver_.add_pixel(waveform.ranges_m, waveform.counts, waveforms);
    receiver_.time(waveforms);
    Detection detection;
    receiver_.receive(0, waveforms, std::span(&detection, 1));
    double height = 0;
    for (const Echo& echo : waveforms.echoes) height = std::max(height, echo.signal_pe * echo.peak);
    return {height, ns_of(detection.range_m)};
  }

 private:
  Receiver receiver_;
};

int run(const std::array<double, 3>& numbers) {
  ReceiverParameters parameters;
  parameters.pulse_fwhm_s = kNs * numbers[0];
  parameters.threshold_pe = numbers[1];
  parameters.fraction = numbers[2];
  parameters.photon_noise = false;
  std::vector<Bench> benches;
  for (const ReceiverType type : {ReceiverType::leading_edge, ReceiverType::constant_fraction,
                                  ReceiverType::peak, ReceiverType::centroid}) {
    parameters.type = type;
    benches.emplace_back(parameters);
  }
  const double offset_ns =
      numbers[0] / std::sqrt(8 * std::log(2.0)) * std::sqrt(2 * std::log(1 / numbers[2]));
  for (std::string line; std::getline(std::cin, line);) {
    const Waveform waveform = parsed(line);
    std::printf("%.9g", benches[0].hear(waveform).height);
    for (std::size_t i = 0; i < benches.size(); ++i)
      std::printf(" %.9g", benches[i].hear(waveform).time_ns - (i == 1 ? offset_ns : 0));
    std::printf("\n");
  }
  return 0;
}

}  // namespace
}  // namespace landfall

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  return landfall::run({std::stod(argv[1]), std::stod(argv[2]), std::stod(argv[3])});
}
