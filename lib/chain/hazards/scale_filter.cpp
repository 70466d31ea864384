// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/scale_filter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/core/parallel.h"

namespace landfall {
namespace {

constexpr std::size_t kFilteredRows = 16;

struct Tap {
  std::int64_t offset;  ///< steps
  double weight;
};

constexpr std::array<Tap, 7> kLowPass = {{{-5, 3.0 / 512},
                                          {-3, -25.0 / 512},
                                          {-1, 150.0 / 512},
                                          {0, 256.0 / 512},
                                          {1, 150.0 / 512},
                                          {3, -25.0 / 512},
                                          {5, 3.0 / 512}}};
constexpr std::array<Tap, 5> kBlur = {
    {{-2, 1.0 / 16}, {-1, 4.0 / 16}, {0, 6.0 / 16}, {1, 4.0 / 16}, {2, 1.0 / 16}}};

/// Beyond the border: value(i) = 2 value(edge) - value(mirrored i).
struct PointReflection {
  template <class Value>
  static auto at(std::int64_t i, std::int64_t count, const Value& value) {
    if (i < 0) return 2 * value(0) - value(std::min(-i, count - 1));
    if (i >= count) return 2 * value(count - 1) - value(std::max<std::int64_t>(2 * (count - 1) - i, 0));
    return value(i);
  }
};

struct Repetition {
  template <class Value>
  static auto at(std::int64_t i, std::int64_t count, const Value& value) {
    return value(std::clamp<std::int64_t>(i, 0, count - 1));
  }
};

template <class Border, class T, std::size_t kTaps>
void filter_columns(const Grid<T>& map, Grid<T>& result, std::int64_t row, std::int64_t step,
                    const std::array<Tap, kTaps>& taps) {
  const GridSpec& spec = map.spec();
  const auto out = result.row(row);
  std::ranges::fill(out, T{0});
  for (const Tap& tap : taps) {
    const auto weight = static_cast<T>(tap.weight);
    const std::int64_t from = row + tap.offset * step;
    if (from >= 0 && from < spec.rows) {
      const auto values = map.row(from);
      for (std::size_t c = 0; c < out.size(); ++c) out[c] += weight * values[c];
    } else {
      for (std::size_t c = 0; c < out.size(); ++c)
        out[c] += weight * Border::at(from, spec.rows, [&](std::int64_t r) { return map.row(r)[c]; });
    }
  }
}

template <class Border, class T, std::size_t kTaps>
void filter_row(std::span<T> row, std::int64_t step, const std::array<Tap, kTaps>& taps,
                std::vector<T>& padded) {
  const auto cols = static_cast<std::int64_t>(row.size());
  const std::int64_t margin = taps.back().offset * step;
  padded.resize(static_cast<std::size_t>(cols + 2 * margin));
  const auto value = [&](std::int64_t c) { return row[static_cast<std::size_t>(c)]; };
  for (std::int64_t c = 0; c < margin; ++c) {
    padded[static_cast<std::size_t>(c)] = Border::at(c - margin, cols, value);
    padded[static_cast<std::size_t>(margin + cols + c)] = Border::at(cols + c, cols, value);
  }
  std::ranges::copy(row, padded.begin() + margin);
  std::ranges::fill(row, T{0});
  for (const Tap& tap : taps) {
    const auto weight = static_cast<T>(tap.weight);
    const T* const from = padded.data() + margin + tap.offset * step;
    for (std::size_t c = 0; c < row.size(); ++c) row[c] += weight * from[c];
  }
}

template <class Border, class T, std::size_t kTaps>
Grid<T> filtered(const Grid<T>& map, std::int64_t step, const std::array<Tap, kTaps>& taps) {
  auto result = Grid<T>::unset(map.spec());
  parallel_for(
      static_cast<std::size_t>(map.spec().rows), kFilteredRows, [&](std::size_t begin, std::size_t end) {
        std::vector<T> padded;
        for (auto row = static_cast<std::int64_t>(begin); row < static_cast<std::int64_t>(end); ++row) {
          filter_columns<Border>(map, result, row, step, taps);
          filter_row<Border>(result.row(row), step, taps, padded);
        }
      });
  return result;
}

/// The taps of the low pass over all scales before `scale`, along one axis.
std::vector<double> cumulated(std::int64_t scale) {
  std::vector<double> taps = {1};
  for (std::int64_t j = 0; j < scale; ++j) {
    const std::int64_t step = std::int64_t{1} << j;
    std::vector<double> wider(taps.size() + static_cast<std::size_t>(2 * kLowPassReach * step));
    for (const Tap& tap : kLowPass)
      for (std::size_t i = 0; i < taps.size(); ++i)
        wider[i + static_cast<std::size_t>((tap.offset + kLowPassReach) * step)] += tap.weight * taps[i];
    taps = std::move(wider);
  }
  return taps;
}

/// The sum of the products of two sets of taps about the same centre; `a` is the shorter.
double product(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t shift = (b.size() - a.size()) / 2;
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i + shift];
  return sum;
}

}  // namespace

template <class T>
Grid<T> low_pass(const Grid<T>& map, std::int64_t step) {
  return filtered<PointReflection>(map, step, kLowPass);
}
template Grid<float> low_pass(const Grid<float>& map, std::int64_t step);
template Grid<double> low_pass(const Grid<double>& map, std::int64_t step);

Grid<float> blur(const Grid<float>& map, std::int64_t step) { return filtered<Repetition>(map, step, kBlur); }

NoiseGains noise_gains(std::int64_t scales) {
  NoiseGains gains;
  std::vector<double> fine = cumulated(0);
  for (std::int64_t j = 0; j < scales; ++j) {
    std::vector<double> coarse = cumulated(j + 1);
    const auto square = [](double value) { return value * value; };
    // The gain of a x a - b x b, the detail's taps in two dimensions.
    gains.detail.push_back(std::sqrt(square(product(fine, fine)) - 2 * square(product(fine, coarse)) +
                                     square(product(coarse, coarse))));
    fine = std::move(coarse);
  }
  gains.rest = product(fine, fine);
  return gains;
}

}  // namespace landfall
