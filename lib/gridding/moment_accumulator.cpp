// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/moment_accumulator.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <new>

#include "base/parallel.h"

namespace landfall {
namespace {

static_assert(sizeof(BinMoments) == 24);

constexpr std::size_t kPointsPerPass = std::size_t{1} << 22U;

/// As in bin_accumulator.cpp: memory that costs nothing until it is touched.
BinMoments* zeroed_moments(std::size_t count) {
  void* memory = std::calloc(count, sizeof(BinMoments));
  if (memory == nullptr) throw std::bad_alloc();
  return static_cast<BinMoments*>(memory);
}

void add_to(float& sum, double term) { sum = static_cast<float>(sum + term); }

}  // namespace

MomentAccumulator::MomentAccumulator(const GridSpec& spec)
    : spec_(spec), moments_(zeroed_moments(spec.size())), partition_(spec) {}

void MomentAccumulator::add(const GridPoints& points, const BinAccumulator& bins) {
  assert(bins.spec() == spec_);
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPass) {
    const GridPoints piece = points.subset(begin, std::min(kPointsPerPass, points.size() - begin));
    partition_.assign(piece.x_est, piece.y_est);
    parallel_for(partition_.band_count(), 1, [&](std::size_t band, std::size_t) {
      for (const std::uint32_t i : partition_.points_of_band(band)) add_point(piece, i, bins);
    });
  }
}

void MomentAccumulator::add_point(const GridPoints& points, std::size_t i, const BinAccumulator& bins) {
  const BinIndex index = spec_.bin_of(points.x_est[i], points.y_est[i]);
  const double dx = points.x_est[i] - spec_.x(index.col);
  const double dy = points.y_est[i] - spec_.y(index.row);
  const double dz = points.z_est[i] - bins.bins()[spec_.index(index)].z_first;
  const double w = (1 - std::abs(dx) / spec_.resolution_m) * (1 - std::abs(dy) / spec_.resolution_m);
  BinMoments& bin = moments_[spec_.index(index)];
  add_to(bin.w_w, w * w);
  add_to(bin.w_dx_dx, w * dx * dx);
  add_to(bin.w_dx_dy, w * dx * dy);
  add_to(bin.w_dy_dy, w * dy * dy);
  add_to(bin.w_dx_dz, w * dx * dz);
  add_to(bin.w_dy_dz, w * dy * dz);
}

}  // namespace landfall
