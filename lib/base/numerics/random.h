// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "base/numerics/philox.h"
#include "base/numerics/random_seed.h"

namespace landfall {

/// One stream per source of randomness, so that enabling or disabling one changes no draw of another. Files
/// are reproducible only if these values never change.
enum class RandomStream : std::uint64_t {
  range_noise = 1,
  dropout = 2,
  dead_pixel = 3,
  fractal = 4,
  encoder = 5,
  false_return = 6,
  pointing_jitter = 8,
  time_stamp = 9,
  navigation_walk = 10,
  disturbance = 11,
  risley_encoder = 12,
  gauss_markov = 13,
  mirror_time = 14,
  facet_tilt = 15,
  penitente = 20,
  rock_population = 21,
  ice_block_population = 22,
  crater_population = 23,
  line_population = 24,
  map_noise = 30,
  lmeds = 31,
  variation = 40,
  photon_count = 50,
  photon_time = 51,
  background = 52,
  timing_jitter = 53,
  pixel_offset = 54,
  touchdown = 60,
  landing_yaw = 61,
  likeness = 70,
};

/// Random numbers as a pure function of (seed, draw, stream, i, j): Philox4x64-10 (Salmon et al. 2011) with
/// the key (seed, stream) and the counter (i, j, draw, 0). No state: any thread may draw any element in any
/// order.
class RandomField {
 public:
  constexpr RandomField(RandomSeed seed, RandomStream stream)
      : key_{{seed.seed, static_cast<std::uint64_t>(stream)}}, draw_(seed.draw) {}

  /// Uniform in [0, 1), a multiple of 2^-53.
  [[nodiscard]] double uniform(std::uint64_t i, std::uint64_t j = 0) const {
    return uniform_of(philox_block(key_, i, j, draw_)[0]);
  }
  /// out[k] = 1 where uniform(i, first_j + k) < limit, otherwise 0.
  void find_less(std::uint64_t i, std::uint64_t first_j, double limit, std::span<std::int8_t> out) const;

  /// Standard normal by Box-Muller; |value| <= 8.6. The same bits on every machine.
  [[nodiscard]] double normal(std::uint64_t i, std::uint64_t j = 0) const;
  /// The draws (i, first_j), (i, first_j + 1), ..., bit for bit those of normal(), many times as fast.
  void normals(std::uint64_t i, std::uint64_t first_j, std::span<double> out) const;
  /// As normals(), for the draws (first_i, j), (first_i + 1, j), ...
  void normals_along_i(std::uint64_t first_i, std::uint64_t j, std::span<double> out) const;

 private:
  r123::Philox4x64::key_type key_;
  std::uint64_t draw_;
};

}  // namespace landfall
