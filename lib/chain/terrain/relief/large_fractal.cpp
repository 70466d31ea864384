// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D122
#include "chain/terrain/relief/large_fractal.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "chain/terrain/relief/fractal_waves.h"

namespace landfall {
namespace {

constexpr std::int64_t kCoarse = 8;     // nodes per node of the long waves' grid
constexpr std::int64_t kLimit = 64;     // L1, nodes
constexpr std::int64_t kPatch = 512;    // period of a patch
constexpr std::int64_t kOverlap = 128;  // of neighbouring patches
constexpr std::int64_t kStep = kPatch - kOverlap;
constexpr std::size_t kFractalRows = 16;

/// Patches are numbered along each axis; patch a covers nodes [a kStep - kOverlap, (a + 1) kStep).
std::int64_t first_node(std::int64_t patch) { return patch * kStep - kOverlap; }
/// The first and the last patch that cover a node.
std::int64_t first_patch(std::int64_t node) { return node / kStep; }
std::int64_t last_patch(std::int64_t node) { return (node + kOverlap) / kStep; }

/// The weights of a patch along an axis.
std::array<double, kPatch> patch_weights() {
  std::array<double, kPatch> weights;
  weights.fill(1);
  for (std::size_t i = 0; i < kOverlap; ++i) {
    const double angle = std::numbers::pi / 2 * (static_cast<double>(i) + 0.5) / kOverlap;
    weights[i] = portable::sin(angle);
    weights[kStep + i] = portable::cos(angle);
  }
  return weights;
}

/// The weights of four neighbours for a point at fraction t between the second and the third.
std::array<double, 4> cubic_weights(double t) {
  return {((-0.5 * t + 1) * t - 0.5) * t, (1.5 * t - 2.5) * t * t + 1, ((-1.5 * t + 2) * t + 0.5) * t,
          (0.5 * t - 0.5) * t * t};
}

GridSpec coarse_grid(const GridSpec& grid) {
  const auto count = [](std::int64_t nodes) { return (nodes - 1) / kCoarse + 4; };
  return {grid.resolution_m * kCoarse, 0, 0, count(grid.rows), count(grid.cols)};
}

WaveDomain patch_domain(const GridSpec& grid) { return {grid.resolution_m, kPatch}; }

/// Both bands of a fractal.
struct Bands {
  WaveBand shorter;
  WaveBand longer;
  Bands(const GridSpec& grid, double longest_m)
      : shorter{0, std::min(longest_m, kLimit * grid.resolution_m)},
        longer{kLimit * grid.resolution_m, longest_m} {}
  [[nodiscard]] bool has_longer() const { return longer.from_m < longer.below_m; }
};

/// The patches of a layer use layers above those of all bases: a model has at most 2^32 bases.
std::uint64_t patch_layer(std::uint64_t layer, std::int64_t number) {
  return layer + (static_cast<std::uint64_t>(number + 1) << 32U);
}

}  // namespace

LargeFractal::LargeFractal(const FractalBase& fractal, const FractalDraw& draw, const GridSpec& grid,
                           const ProgressCallback& progress)
    : fractal_(fractal),
      draw_(draw),
      grid_(grid),
      longest_m_(fractal.longest_wavelength_m.value_or(std::numeric_limits<double>::infinity())),
      patch_amplitude_(law_amplitude(fractal, patch_domain(grid))),
      patch_spectrum_(patch_domain(grid), Bands(grid, longest_m_).shorter, fractal.hurst_exponent) {
  if (Bands(grid_, longest_m_).has_longer()) make_long_waves(progress);
  report(progress, 1);
}

void LargeFractal::make_long_waves(const ProgressCallback& progress) {
  const GridSpec coarse = coarse_grid(grid_);
  const WaveDomain domain = WaveDomain::around(coarse);
  const FractalSpectrum spectrum(domain, Bands(grid_, longest_m_).longer, fractal_.hurst_exponent);
  FractalWaves waves(spectrum, coarse.rows);
  long_waves_ = Grid<double>(coarse);
  waves.draw(draw_, [&](double fraction) { report(progress, fraction / 2); });
  waves.add_to(long_waves_, law_amplitude(fractal_, domain),
               [&](double fraction) { report(progress, 0.5 + fraction / 2); });
}

void LargeFractal::add_long_waves(Grid<double>& strip) const {
  std::array<std::array<double, 4>, kCoarse> weights;
  for (std::size_t i = 0; i < kCoarse; ++i)
    weights[i] = cubic_weights(static_cast<double>(i) / static_cast<double>(kCoarse));
  const std::int64_t first_row = strip.spec().first_row - grid_.first_row;
  parallel_for(
      static_cast<std::size_t>(strip.spec().rows), kFractalRows, [&](std::size_t begin, std::size_t end) {
        std::vector<double> line(static_cast<std::size_t>(long_waves_.spec().cols));
        for (std::size_t r = begin; r < end; ++r) {
          const std::int64_t row = first_row + static_cast<std::int64_t>(r);
          const auto& up = weights[static_cast<std::size_t>(row % kCoarse)];
          std::array<std::span<const double>, 4> near;
          for (std::size_t i = 0; i < 4; ++i)
            near[i] = long_waves_.row(row / kCoarse + static_cast<std::int64_t>(i));
          for (std::size_t c = 0; c < line.size(); ++c)
            line[c] = up[0] * near[0][c] + up[1] * near[1][c] + up[2] * near[2][c] + up[3] * near[3][c];
          const auto out = strip.row(static_cast<std::int64_t>(r));
          for (std::size_t c = 0; c < out.size(); ++c) {
            const auto& along = weights[c % kCoarse];
            const double* const at = &line[c / kCoarse];
            out[c] += along[0] * at[0] + along[1] * at[1] + along[2] * at[2] + along[3] * at[3];
          }
        }
      });
}

Grid<double> LargeFractal::patch(std::int64_t row, std::int64_t col) const {
  const std::int64_t per_row = last_patch(grid_.cols - 1) + 1;
  FractalWaves waves(patch_spectrum_, kPatch);
  waves.draw({draw_.seed, patch_layer(draw_.layer, row * per_row + col)});
  Grid<double> z(GridSpec{grid_.resolution_m, 0, 0, kPatch, kPatch});
  waves.add_to(z, patch_amplitude_);
  return z;
}

const LargeFractal::PatchRow& LargeFractal::patch_row(std::int64_t number, const ProgressCallback& progress) {
  PatchRow& row = patches_[number];
  if (!row.empty()) return row;
  const std::int64_t count = last_patch(grid_.cols - 1) + 1;
  for (std::int64_t col = 0; col < count; ++col) {
    row.push_back(patch(number, col));
    report(progress, static_cast<double>(col + 1) / static_cast<double>(count));
  }
  return row;
}

void LargeFractal::add_patches(Grid<double>& strip, std::int64_t number, const PatchRow& patches) const {
  static const std::array<double, kPatch> weights = patch_weights();
  const std::int64_t strip_row = strip.spec().first_row - grid_.first_row;
  const std::int64_t begin_row = std::max<std::int64_t>(first_node(number) - strip_row, 0);
  const std::int64_t end_row = std::min(first_node(number) + kPatch - strip_row, strip.spec().rows);
  parallel_for(static_cast<std::size_t>(end_row - begin_row), kFractalRows,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t r = begin; r < end; ++r) {
                   const std::int64_t row = begin_row + static_cast<std::int64_t>(r);
                   const std::int64_t patch_line = row + strip_row - first_node(number);
                   const double weight = weights[static_cast<std::size_t>(patch_line)];
                   const auto out = strip.row(row);
                   for (std::int64_t a = 0; a < std::ssize(patches); ++a) {
                     const auto values = patches[static_cast<std::size_t>(a)].row(patch_line);
                     const std::int64_t west = std::max<std::int64_t>(first_node(a), 0);
                     const std::int64_t east = std::min(first_node(a) + kPatch, grid_.cols);
                     for (std::int64_t col = west; col < east; ++col) {
                       const auto i = static_cast<std::size_t>(col - first_node(a));
                       out[static_cast<std::size_t>(col)] += weight * weights[i] * values[i];
                     }
                   }
                 }
               });
}

void LargeFractal::add_to(Grid<double>& strip, const ProgressCallback& progress) {
  if (!long_waves_.values().empty()) add_long_waves(strip);
  const std::int64_t begin = strip.spec().first_row - grid_.first_row;
  const std::int64_t end = begin + strip.spec().rows;
  const std::int64_t first = first_patch(begin);
  const std::int64_t last = last_patch(end - 1);
  patches_.erase(patches_.begin(), patches_.lower_bound(first));
  patches_.erase(patches_.upper_bound(last), patches_.end());
  const double count = static_cast<double>(last - first + 1);
  for (std::int64_t number = first; number <= last; ++number) {
    const double done = static_cast<double>(number - first);
    add_patches(strip, number, patch_row(number, [&](double fraction) {
                  report(progress, std::min(1.0, (done + fraction) / count));
                }));
    if (first_node(number) + kPatch <= end) patches_.erase(number);
  }
  report(progress, 1);
}

}  // namespace landfall
