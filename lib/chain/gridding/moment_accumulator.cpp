// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/moment_accumulator.h"

#include <cassert>
#include <cmath>

namespace landfall {
namespace {

static_assert(sizeof(BinMoments) == 24);

void add_to(float& sum, double term) { sum = static_cast<float>(sum + term); }

void add_return(double dx, double dy, double dz, double w, BinMoments& bin) {
  add_to(bin.w_w, w * w);
  add_to(bin.w_dx_dx, w * dx * dx);
  add_to(bin.w_dx_dy, w * dx * dy);
  add_to(bin.w_dy_dy, w * dy * dy);
  add_to(bin.w_dx_dz, w * dx * dz);
  add_to(bin.w_dy_dz, w * dy * dz);
}

}  // namespace

MomentAccumulator::MomentAccumulator(const GridSpec& spec)
    : spec_(spec), moments_(spec.size()), nearest_(spec) {}

void MomentAccumulator::add(const GridPoints& points, const WeightedMeanAccumulator& bins) {
  assert(bins.spec() == spec_);
  const std::span<BinMoments> moments = moments_.values();
  const std::span<const BinSums> sums = bins.bins();
  const auto add_point = [=](const GridSpec& spec, const GridPoints& piece, std::size_t i, std::size_t bin) {
    const BinIndex index = spec.bin_of(piece.x_est[i], piece.y_est[i]);
    const double dx = piece.x_est[i] - spec.x(index.col);
    const double dy = piece.y_est[i] - spec.y(index.row);
    const double w = (1 - std::abs(dx) / spec.resolution_m) * (1 - std::abs(dy) / spec.resolution_m);
    add_return(dx, dy, piece.z_est[i] - sums[bin].z_first, w, moments[bin]);
  };
  static_cast<void>(nearest_.for_each(points, add_point));
}

}  // namespace landfall
