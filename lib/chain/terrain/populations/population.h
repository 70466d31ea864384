// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/numerics/random.h"
#include "chain/terrain/features/feature.h"
#include "chain/terrain/populations/region.h"
#include "chain/terrain/populations/size_law.h"

namespace landfall {

/// Randomly scattered objects: their number per area and size, and their region.
struct Population {
  SizeLaw law;
  DiameterRange diameters;
  Region region = SiteRegion{};
  double clear_radius_m = 0;  ///< objects keep out of this circle about the origin; 0: no such circle
  bool overlap = true;        ///< false: no two objects of this population overlap
  /// Draws are functions of the site's seed and of this seed; empty: of the pattern's number instead.
  std::optional<std::uint64_t> seed = std::nullopt;

  /// Throws UsageError unless the parameters of the law are valid, 0 < min_m < max_m < 1e6, the region is
  /// valid, the clear radius is finite and >= 0, and the seed is below 2^32.
  void validate(const std::string& owner) const;
  friend bool operator==(const Population&, const Population&) = default;
};

/// Objects that one task draws.
inline constexpr std::size_t kObjectsPerPiece = 4096;
/// Bits of a draw's number below the seed of the population.
inline constexpr std::uint64_t kDrawBits = 12;

/// The kind of objects in a population.
struct PopulationKind {
  const char* name;     ///< of one, for messages: "rock"
  RandomStream stream;  ///< of the draws of the objects
  double reach;         ///< of an object about its centre, in diameters
  bool from_outside;    ///< objects whose centre is off the site count where they reach into it
};

/// An object of a population. Its `key` is unique: its further draws are functions of it.
struct ScatteredObject {
  SitePoint point;
  double diameter_m = 0;
  std::uint64_t key = 0;
};

/// Draws a population on a site: a Poisson process in position and size, of density dN(>D) per area. Within
/// each octave (2^n, 2^(n+1)] of D in metres, from the largest down, the numbers N(>D) of the objects are
/// sums of independent exponential draws divided by the area, so that counts are Poisson-distributed and
/// sizes descend (docs/reference/decisions.md, D112). Object i of an octave is a function of (seed, draw,
/// octave, i), independent of the other octaves: another least or greatest diameter only removes or adds
/// objects.
///
/// With overlap == false, an object whose disc of reach overlaps a larger one is drawn again at another
/// position, up to 1000 times.
class PopulationSampler {
 public:
  /// The population must be valid. Throws UsageError, naming pattern and number, if the region does not meet
  /// the site or if more than kMaxObjects are expected in the rectangles that hold it.
  PopulationSampler(const Population& population, const PopulationKind& kind, const PatternSite& site);

  static constexpr double kMaxObjects = 1e7;

  /// All objects, in descending order of diameter. The result does not depend on the number of threads.
  /// Throws UsageError if an object finds no free position.
  [[nodiscard]] std::vector<ScatteredObject> objects() const;

  /// Further draws of an object: `draw` in 0..7.
  [[nodiscard]] double uniform(const ScatteredObject& object, std::uint64_t draw) const;
  [[nodiscard]] double normal(const ScatteredObject& object, std::uint64_t draw) const;

 private:
  /// An octave of diameters, and the area where its objects may lie.
  struct Octave {
    int exponent;
    DiameterRange diameters;
    Box box;
  };

  [[nodiscard]] std::string name() const;
  [[nodiscard]] Octave octave(int exponent) const;
  [[nodiscard]] std::vector<Octave> octaves() const;
  void require_bounded() const;
  [[nodiscard]] std::vector<ScatteredObject> draw(const Octave& octave) const;
  [[nodiscard]] SitePoint draw_point(std::uint64_t key, std::uint64_t attempt, const Box& box) const;
  [[nodiscard]] bool admits(const ScatteredObject& object) const;
  void spread(std::vector<ScatteredObject>& objects) const;

  Population population_;
  PopulationKind kind_;
  Box site_;
  std::uint64_t pattern_;
  std::uint64_t seed_;
  RandomField random_;
};

}  // namespace landfall
