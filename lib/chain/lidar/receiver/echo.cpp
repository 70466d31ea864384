// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D341, D348
#include "chain/lidar/receiver/echo.h"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace landfall {

void EchoRays::clear(std::size_t rays_per_pixel) {
  rays_ = rays_per_pixel;
  size_ = 0;
  ranges_m_.clear();
  signals_pe_.clear();
}

std::size_t EchoRays::add_pixel(std::span<double> ranges_m, std::span<double> signals_pe, double gap_m) {
  assert(ranges_m.size() == signals_pe.size() && ranges_m.size() <= rays_);
  std::size_t count = 0;
  for (std::size_t j = 0; j < ranges_m.size(); ++j) {
    if (!(ranges_m[j] >= 0) || !(signals_pe[j] > 0)) continue;
    ranges_m[count] = ranges_m[j];
    signals_pe[count++] = signals_pe[j];
  }
  if (count == 0) return 0;
  const auto ranges = ranges_m.first(count);
  const auto signals = signals_pe.first(count);
  const auto [nearest, farthest] = std::ranges::minmax(ranges);
  if (farthest - nearest <= gap_m) {
    add_echo(ranges, signals);
    return 1;
  }
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::ranges::stable_sort(order_, {}, [&](std::size_t j) { return ranges[j]; });
  sorted_.resize(2 * count);
  for (std::size_t j = 0; j < count; ++j) {
    sorted_[j] = ranges[order_[j]];
    sorted_[count + j] = signals[order_[j]];
  }
  const std::span<const double> sorted(sorted_);
  std::size_t echoes = 0;
  for (std::size_t begin = 0, end = 1; begin < count; begin = end++) {
    while (end < count && sorted[end] - sorted[end - 1] <= gap_m) ++end;
    add_echo(sorted.subspan(begin, end - begin), sorted.subspan(count + begin, end - begin));
    ++echoes;
  }
  return echoes;
}

void EchoRays::add_echo(std::span<const double> ranges_m, std::span<const double> signals_pe) {
  const std::size_t echo = size_++;
  if (echo % kBlock == 0) {
    ranges_m_.resize(ranges_m_.size() + rays_ * kBlock, 0.0);
    signals_pe_.resize(ranges_m_.size(), 0.0);
  }
  for (std::size_t j = 0; j < ranges_m.size(); ++j) {
    ranges_m_[index(echo, j)] = ranges_m[j];
    signals_pe_[index(echo, j)] = signals_pe[j];
  }
}

}  // namespace landfall
