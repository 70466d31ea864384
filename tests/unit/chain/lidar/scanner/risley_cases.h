// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <random>
#include <string>

#include "chain/lidar/scanner/risley_steering.h"
#include "constants.h"
#include "test_seed.h"

namespace landfall {

inline constexpr std::array<RisleyConfiguration, 4> kRisleyConfigurations{
    RisleyConfiguration::pttp, RisleyConfiguration::tppt, RisleyConfiguration::ptpt,
    RisleyConfiguration::tptp};

/// The letters of a configuration: faces 0..3 in the order of the beam.
inline std::string letters(RisleyConfiguration configuration) {
  return std::array<std::string, 4>{"PTTP", "TPPT", "PTPT", "TPTP"}[static_cast<std::size_t>(configuration)];
}

/// Random prisms and angles; LANDFALL_TEST_SEED sets the seed.
class RisleyDraws {
 public:
  double uniform(double from, double to) { return std::uniform_real_distribution(from, to)(random_); }
  RisleyOptics optics(RisleyConfiguration configuration) {
    return {.prisms = {prism(), prism()}, .gap_m = uniform(0, 0.02), .configuration = configuration};
  }
  RisleyAngles angles() { return {uniform(-4, 4), uniform(-4, 4)}; }

 private:
  RisleyPrism prism() { return {uniform(1.3, 2), uniform(1, 15) * kDegree, uniform(0.001, 0.02)}; }

  std::mt19937_64 random_{test_seed()};
};

}  // namespace landfall
