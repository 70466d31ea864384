// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/relief_prior.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/core/parallel.h"
#include "base/numerics/portable_math.h"
#include "base/numerics/rounding.h"
#include "chain/hazards/scale_filter.h"

namespace landfall {
namespace {

constexpr std::size_t kClasses = 11;
/// Variance of the true detail over that of noise.
constexpr std::array<double, kClasses> kRatios = {0, 1.0 / 64, 1.0 / 16, 0.25, 0.7, 2, 6, 20, 80, 400, 4000};
/// Degrees of freedom of the mean square of the details about a bin: 10.6 to 15.5 at four scales of white
/// noise.
constexpr double kFreedom = 11.5;
constexpr int kSteps = 2;
/// Spread of the logarithm by which relief may exceed that of the next coarser scale.
constexpr double kRedness = 0.4;
constexpr double kCellM = 0.6;
constexpr std::int64_t kMinCellBins = 2;
constexpr std::int64_t kCellReach = 2;
constexpr std::array<double, 2 * kCellReach + 1> kCellWeights = {1, 4, 6, 4, 1};
/// The smallest share from which a detail shows the relief around it.
constexpr float kSeen = 0.5F;

using Probabilities = std::array<float, kClasses>;

/// A function of a positive ratio, in steps of 1/16 octave.
class RatioTable {
 public:
  template <class Function>
  explicit RatioTable(const Function& function) : rows_(static_cast<std::size_t>(kLast - kFirst) + 1) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const auto from = std::bit_cast<float>((kFirst + static_cast<std::uint32_t>(i)) << kShift);
      const auto to = std::bit_cast<float>((kFirst + static_cast<std::uint32_t>(i) + 1) << kShift);
      rows_[i] = function((static_cast<double>(from) + static_cast<double>(to)) / 2);
    }
  }
  [[nodiscard]] const Probabilities& at(float ratio) const {
    const float bounded = std::clamp(ratio, kSmallest, kLargest);
    return rows_[(std::bit_cast<std::uint32_t>(bounded) >> kShift) - kFirst];
  }

 private:
  static constexpr std::uint32_t kShift = 19;  // 4 of the 23 bits of the mantissa remain
  static constexpr float kSmallest = 0x1p-30F, kLargest = 0x1p30F;
  static constexpr std::uint32_t kFirst = std::bit_cast<std::uint32_t>(kSmallest) >> kShift;
  static constexpr std::uint32_t kLast = std::bit_cast<std::uint32_t>(kLargest) >> kShift;
  std::vector<Probabilities> rows_;
};

/// Likelihood of each class, given the mean square of details over V; the largest is 1, the least 1e-18.
Probabilities likelihoods(double energy) {
  std::array<double, kClasses> logs{};
  for (std::size_t k = 0; k < kClasses; ++k)
    logs[k] = -0.5 * kFreedom * (portable::log1p(kRatios[k]) + energy / (1 + kRatios[k]));
  const double largest = *std::ranges::max_element(logs);
  Probabilities result{};
  for (std::size_t k = 0; k < kClasses; ++k)
    result[k] = static_cast<float>(std::max(portable::exp(logs[k] - largest), 1e-18));
  return result;
}

/// Weight of each class, given the relief of the next coarser scale over V; 1 .. 1e-12.
Probabilities redness(double coarser) {
  Probabilities result{};
  for (std::size_t k = 0; k < kClasses; ++k) {
    const double excess = kRatios[k] > coarser ? portable::log(kRatios[k] / coarser) / kRedness : 0;
    result[k] = static_cast<float>(std::max(portable::exp(-0.5 * excess * excess), 1e-12));
  }
  return result;
}

const RatioTable& likelihood_table() {
  static const RatioTable kTable(likelihoods);
  return kTable;
}

const RatioTable& redness_table() {
  static const RatioTable kTable(redness);
  return kTable;
}

/// Square groups of bins whose edges are at multiples of `bins` from bin (0, 0).
class Cells {
 public:
  Cells(const GridSpec& spec, std::int64_t bins)
      : spec_(spec),
        bins_(bins),
        first_row_(floor_div(spec.first_row, bins)),
        first_col_(floor_div(spec.first_col, bins)),
        rows_(floor_div(spec.first_row + spec.rows - 1, bins) - first_row_ + 1),
        cols_(floor_div(spec.first_col + spec.cols - 1, bins) - first_col_ + 1) {}

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(rows_ * cols_); }
  [[nodiscard]] std::size_t of(BinIndex bin) const {
    return static_cast<std::size_t>((floor_div(spec_.first_row + bin.row, bins_) - first_row_) * cols_ +
                                    floor_div(spec_.first_col + bin.col, bins_) - first_col_);
  }
  /// work(row) for the map's rows, those of one row of cells on one thread and in order.
  template <class Work>
  void by_rows(const Work& work) const {
    parallel_for(static_cast<std::size_t>(rows_), 1, [&](std::size_t begin, std::size_t end) {
      for (auto cell = static_cast<std::int64_t>(begin); cell < static_cast<std::int64_t>(end); ++cell) {
        const std::int64_t first = (first_row_ + cell) * bins_ - spec_.first_row;
        for (std::int64_t row = std::max<std::int64_t>(first, 0); row < std::min(first + bins_, spec_.rows);
             ++row)
          work(row);
      }
    });
  }
  /// Each cell becomes the weighted sum over the 5 x 5 cells about it, as far as they are on the map.
  template <std::size_t kValues>
  void blur(std::vector<std::array<float, kValues>>& values) const {
    const std::vector<std::array<float, kValues>> before = values;
    for (std::int64_t row = 0; row < rows_; ++row)
      for (std::int64_t col = 0; col < cols_; ++col) {
        std::array<double, kValues> sum{};
        for (std::int64_t r = -kCellReach; r <= kCellReach; ++r)
          for (std::int64_t c = -kCellReach; c <= kCellReach; ++c) {
            if (row + r < 0 || row + r >= rows_ || col + c < 0 || col + c >= cols_) continue;
            const double weight = kCellWeights[static_cast<std::size_t>(r + kCellReach)] *
                                  kCellWeights[static_cast<std::size_t>(c + kCellReach)];
            const auto& from = before[static_cast<std::size_t>((row + r) * cols_ + col + c)];
            for (std::size_t k = 0; k < kValues; ++k) sum[k] += weight * static_cast<double>(from[k]);
          }
        for (std::size_t k = 0; k < kValues; ++k)
          values[static_cast<std::size_t>(row * cols_ + col)][k] = static_cast<float>(sum[k]);
      }
  }

 private:
  GridSpec spec_;
  std::int64_t bins_, first_row_, first_col_, rows_, cols_;
};

/// The mean of the measured bins about each bin, blurred over the scale.
Grid<float> mean_of_seen(Grid<float> values, const ScaleDetails& scale) {
  const GridSpec& spec = values.spec();
  for (std::size_t i = 0; i < spec.size(); ++i) values.values()[i] *= scale.seen.values()[i];
  values = blur(values, scale.step);
  const Grid<float> weight = blur(scale.seen, scale.step);
  for (std::size_t i = 0; i < spec.size(); ++i) values.values()[i] /= std::max(weight.values()[i], 1e-3F);
  return values;
}

/// The mean square of the details about each bin over V.
Grid<float> energy_of(const ScaleDetails& scale) {
  const GridSpec& spec = scale.detail_m.spec();
  auto energy = Grid<float>::unset(spec);
  for (std::size_t i = 0; i < spec.size(); ++i) {
    const float detail = scale.detail_m.values()[i];
    energy.values()[i] = detail * detail / scale.noise_m2.values()[i];
  }
  return mean_of_seen(std::move(energy), scale);
}

/// P(class) times its likelihood, of sum 1.
Probabilities posterior(const Probabilities& prior, const Probabilities& likelihood) {
  Probabilities result{};
  float sum = 0;
  for (std::size_t k = 0; k < kClasses; ++k) {
    result[k] = prior[k] * likelihood[k];
    sum += result[k];
  }
  for (float& value : result) value /= sum;
  return result;
}

/// The probabilities of the classes in each cell.
std::vector<Probabilities> region_prior(const ScaleDetails& scale, const Grid<float>& energy,
                                        const Cells& cells) {
  Probabilities equal{};
  equal.fill(1.0F / kClasses);
  std::vector<Probabilities> prior(cells.count(), equal);
  const RatioTable& table = likelihood_table();
  for (int step = 0; step < kSteps; ++step) {
    std::vector<Probabilities> next(cells.count(), Probabilities{});
    cells.by_rows([&](std::int64_t row) {
      for (std::int64_t col = 0; col < energy.spec().cols; ++col) {
        const BinIndex bin{row, col};
        if (scale.seen.at(bin) < kSeen) continue;
        const std::size_t cell = cells.of(bin);
        const Probabilities found = posterior(prior[cell], table.at(energy.at(bin)));
        for (std::size_t k = 0; k < kClasses; ++k) next[cell][k] += found[k];
      }
    });
    cells.blur(next);
    for (Probabilities& cell : next) {
      float sum = 0;
      for (const float value : cell) sum += value;
      if (!(sum > 0)) {
        cell = equal;
        continue;
      }
      for (float& value : cell) value = std::max(value / sum, 1e-7F);
    }
    prior = std::move(next);
  }
  return prior;
}

}  // namespace

std::int64_t prior_cell_bins(double resolution_m) {
  return std::max(static_cast<std::int64_t>(std::lround(kCellM / resolution_m)), kMinCellBins);
}

std::int64_t relief_reach_bins(std::int64_t step, double resolution_m) {
  return 2 * kBlurReach * step + (kSteps + 1) * ((kCellReach + 1) * prior_cell_bins(resolution_m) - 1);
}

ScaleRelief relief_of(const ScaleDetails& scale, const Grid<float>* coarser) {
  const GridSpec& spec = scale.detail_m.spec();
  const Cells cells(spec, prior_cell_bins(spec.resolution_m));
  const Grid<float> energy = energy_of(scale);
  const std::vector<Probabilities> prior = region_prior(scale, energy, cells);
  ScaleRelief result{Grid<float>::unset(spec), Grid<float>::unset(spec), Grid<float>::unset(spec)};
  std::vector<std::array<float, 2>> around(cells.count(), {0, 0});  // sum of relief, number of bins
  cells.by_rows([&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex bin{row, col};
      const std::size_t cell = cells.of(bin);
      const float noise = scale.noise_m2.at(bin);
      Probabilities likelihood = likelihood_table().at(energy.at(bin));
      if (coarser != nullptr) {
        const Probabilities& red = redness_table().at(coarser->at(bin) / noise);
        for (std::size_t k = 0; k < kClasses; ++k) likelihood[k] *= red[k];
      }
      const Probabilities found = posterior(prior[cell], likelihood);
      float gain = 0;
      float gain_square = 0;
      float relief = 0;
      for (std::size_t k = 0; k < kClasses; ++k) {
        const auto ratio = static_cast<float>(kRatios[k]);
        const float g = ratio / (1 + ratio);
        gain += found[k] * g;
        gain_square += found[k] * g * g;
        relief += found[k] * ratio;
      }
      // Beyond the last class the energy itself is used.
      if (const float excess = energy.at(bin) - 1; excess > kRatios.back()) relief = std::max(relief, excess);
      const float detail = scale.detail_m.at(bin);
      result.gain.at(bin) = gain;
      result.spread_m2.at(bin) = gain * noise + std::max(gain_square - gain * gain, 0.0F) * detail * detail;
      result.relief_m2.at(bin) = relief * noise;
      if (scale.seen.at(bin) < kSeen) continue;
      around[cell][0] += relief * noise;
      around[cell][1] += 1;
    }
  });
  cells.blur(around);
  cells.by_rows([&](std::int64_t row) {
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      const BinIndex bin{row, col};
      const float seen = std::min(scale.seen.at(bin) / kSeen, 1.0F);
      if (seen == 1) continue;
      const auto& [sum, count] = around[cells.of(bin)];
      const float typical = count > 0 ? sum / count : 0;
      result.gain.at(bin) *= seen;
      result.spread_m2.at(bin) = seen * result.spread_m2.at(bin) + (1 - seen) * typical;
    }
  });
  result.relief_m2 = mean_of_seen(std::move(result.relief_m2), scale);
  return result;
}

}  // namespace landfall
