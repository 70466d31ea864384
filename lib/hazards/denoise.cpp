// SPDX-License-Identifier: GPL-3.0-or-later
#include "hazards/denoise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/parallel.h"
#include "hazards/lander.h"
#include "raster/window_mean.h"

namespace landfall {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kDenoisedRows = 32;
constexpr std::int64_t kReach = 2;
/// Returns in a bin vary by more than the mean of 1 / sigma^2 tells.
constexpr double kNoiseSpread = 1.3;

/// Calls work(begin, end) for pieces of a map's rows, on all threads.
template <class Work>
void by_pieces(std::int64_t rows, const Work& work) {
  parallel_for(static_cast<std::size_t>(rows), kDenoisedRows, [&](std::size_t begin, std::size_t end) {
    work(static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end));
  });
}

/// Some rows of a map with `margin` columns of NaN on both sides; NaN off the map.
class Band {
 public:
  Band(std::int64_t first_row, std::int64_t end_row, std::int64_t cols, std::int64_t margin)
      : first_row_(first_row),
        end_row_(end_row),
        margin_(margin),
        pitch_(cols + 2 * margin),
        values_(static_cast<std::size_t>((end_row - first_row) * pitch_), kUnknown) {}

  void copy(const Grid<double>& map) {
    const std::int64_t end = std::min(end_row_, map.spec().rows);
    for (std::int64_t row = std::max<std::int64_t>(first_row_, 0); row < end; ++row)
      std::ranges::copy(map.row(row), at(row, 0));
  }
  [[nodiscard]] double* at(std::int64_t row, std::int64_t col) {
    return values_.data() + (row - first_row_) * pitch_ + col + margin_;
  }

 private:
  std::int64_t first_row_, end_row_, margin_, pitch_;
  std::vector<double> values_;
};

/// The weight of a neighbour in the value at the centre of the least-squares quadratic surface through the 24
/// bins around it: the first row of (A^T A)^-1 A^T. By symmetry the surface's terms in x, y and x y do not
/// matter there, and those in x^2 and y^2 have one coefficient: with n = 24, sum x^2 = 50, sum x^4 = 170,
/// sum x^2 y^2 = 100, the equations n a + 100 b = 1 and 50 a + 270 b = 0.
double weight(std::int64_t rows, std::int64_t cols) {
  constexpr double kDeterminant = 24.0 * 270 - 50.0 * 100;
  return (270 - 50 * static_cast<double>(rows * rows + cols * cols)) / kDeterminant;
}

struct Neighbour {
  BinOffset offset;
  double weight;
};

std::vector<Neighbour> neighbours() {
  std::vector<Neighbour> found;
  for (std::int64_t row = -kReach; row <= kReach; ++row)
    for (std::int64_t col = -kReach; col <= kReach; ++col)
      if (row != 0 || col != 0) found.push_back({{row, col}, weight(row, col)});
  return found;
}

/// What the bins around say of the bins of some rows: NaN where one is missing.
struct Predictions {
  Band z, noise;  ///< value, and its variance by the noise of the bins
  Band excess;    ///< squared misfit of the bin less its expectation
};

/// Of rows begin - 1 .. end and one column more on both sides.
Predictions predict(const Grid<double>& z_map, const Grid<double>& noise_map, std::int64_t begin,
                    std::int64_t end) {
  const std::int64_t cols = z_map.spec().cols;
  constexpr std::int64_t kMargin = kReach + 1;
  Band z(begin - kMargin, end + kMargin, cols, kMargin);
  Band noise(begin - kMargin, end + kMargin, cols, kMargin);
  z.copy(z_map);
  noise.copy(noise_map);
  const std::vector<Neighbour> around = neighbours();
  Predictions found{Band(begin - 1, end + 1, cols, 1), Band(begin - 1, end + 1, cols, 1),
                    Band(begin - 1, end + 1, cols, 1)};
  for (std::int64_t row = begin - 1; row <= end; ++row) {
    double* const value = found.z.at(row, -1);
    double* const variance = found.noise.at(row, -1);
    double* const excess = found.excess.at(row, -1);
    std::fill_n(value, cols + 2, 0);
    std::fill_n(variance, cols + 2, 0);
    for (const Neighbour& n : around) {
      const double* const from = z.at(row + n.offset.rows, n.offset.cols - 1);
      const double* const noise_from = noise.at(row + n.offset.rows, n.offset.cols - 1);
      for (std::int64_t c = 0; c < cols + 2; ++c) {
        value[c] += n.weight * from[c];
        variance[c] += n.weight * n.weight * (noise_from[c] * noise_from[c]);
      }
    }
    const double* const own = z.at(row, -1);
    const double* const own_noise = noise.at(row, -1);
    for (std::int64_t c = 0; c < cols + 2; ++c) {
      const double misfit = own[c] - value[c];
      excess[c] = misfit * misfit - (variance[c] + own_noise[c] * own_noise[c]);
    }
  }
  return found;
}

}  // namespace

SigmaParts split_sigma(const Grid<double>& z_sigma, const Footprint& window) {
  const GridSpec& spec = z_sigma.spec();
  Grid<double> precision(spec);
  by_pieces(spec.rows, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double sigma = z_sigma.at({row, col});
        const double value = 1 / (sigma * sigma);
        precision.at({row, col}) = std::isfinite(value) ? value : kUnknown;
      }
  });
  SigmaParts parts{window_means(precision, window).mean, std::move(precision)};
  by_pieces(spec.rows, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t row = begin; row < end; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double sigma = z_sigma.at({row, col});
        double& noise_m = parts.noise_m.at({row, col});
        const double typical = 1 / noise_m;
        parts.relief_m.at({row, col}) = std::sqrt(std::max(sigma * sigma - typical, 0.0));
        noise_m = std::isnan(typical) ? sigma : std::min(sigma, std::sqrt(kNoiseSpread * typical));
      }
  });
  return parts;
}

double beyond_noise(double relief_variance, double noise_m) {
  // Where sigma^2 > 1.3 m, noise^2 = 1.3 m and sigma^2 = relief^2 + m; elsewhere noise is sigma.
  return std::max(relief_variance - (1 - 1 / kNoiseSpread) * (noise_m * noise_m), 0.0);
}

Grid<double> denoise(const Grid<double>& z, const Grid<double>& noise_m) {
  const GridSpec& spec = z.spec();
  Grid<double> result = z;
  by_pieces(spec.rows, [&](std::int64_t begin, std::int64_t end) {
    Predictions predicted = predict(z, noise_m, begin, end);
    for (std::int64_t row = begin; row < end; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        const double sigma = noise_m.at({row, col});
        const double own = sigma * sigma;
        double departure = 0;
        for (std::int64_t r = -1; r <= 1; ++r)
          for (std::int64_t c = -1; c <= 1; ++c) departure += *predicted.excess.at(row + r, col + c) / 9;
        const double other = *predicted.noise.at(row, col) + std::max(departure, 0.0);
        if (!std::isfinite(departure) || !(other > 0)) continue;
        double& height = result.at({row, col});
        height += (*predicted.z.at(row, col) - height) * (own / (own + other));
      }
  });
  return result;
}

Grid<double> sharpen(const Grid<double>& z, const Grid<double>& relief_m) {
  const GridSpec& spec = z.spec();
  Grid<double> result = z;
  by_pieces(spec.rows, [&](std::int64_t begin, std::int64_t end) {
    Band ground(begin - kReach, end + kReach, spec.cols, kReach);
    Band curvature(begin - 1, end + 1, spec.cols, 1);
    ground.copy(z);
    for (std::int64_t row = begin - 1; row <= end; ++row)
      for (std::int64_t col = -1; col <= spec.cols; ++col) {
        const double* const at = ground.at(row, col);
        *curvature.at(row, col) =
            *ground.at(row + 1, col) + *ground.at(row - 1, col) + at[1] + at[-1] - 4 * *at;
      }
    for (std::int64_t row = begin; row < end; ++row)
      for (std::int64_t col = 0; col < spec.cols; ++col) {
        double mean = 0;
        for (std::int64_t r = -1; r <= 1; ++r)
          for (std::int64_t c = -1; c <= 1; ++c) mean += *curvature.at(row + r, col + c) / 9;
        const double most = relief_m.at({row, col});
        if (std::isfinite(mean) && most > 0) result.at({row, col}) -= std::clamp(mean / 8, -most, most);
      }
  });
  return result;
}

}  // namespace landfall
