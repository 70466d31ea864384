// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/bin_accumulator.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/parallel.h"
#include "gridding/finite_points.h"

namespace landfall {
namespace {

/// So many points at a time: the partition's own memory stays at 24 MB however large the batch.
constexpr std::size_t kPointsPerPass = std::size_t{1} << 20U;

/// Shorter runs are copied together.
constexpr std::uint32_t kShortRun = 16;

/// Runs too short to be worth a call, one behind the other.
class GatheredRuns {
 public:
  [[nodiscard]] bool has_room(std::size_t count) const { return count_ + count <= kRoom; }
  void append(const GridPoints& p, PointRun run) {
    const std::array<std::span<const double>, 7> from = {p.x_est,  p.y_est,  p.z_est, p.x_true,
                                                         p.y_true, p.z_true, p.t};
    for (std::size_t c = 0; c < from.size(); ++c)
      for (std::size_t i = 0; i < run.count; ++i) columns_[c][count_ + i] = from[c][run.begin + i];
    count_ += run.count;
  }
  [[nodiscard]] GridPoints points() const {
    const auto& c = columns_;
    return GridPoints{c[0], c[1], c[2], c[3], c[4], c[5], c[6]}.subset(0, count_);
  }
  void clear() { count_ = 0; }

 private:
  static constexpr std::size_t kRoom = 256;
  std::array<std::array<double, kRoom>, 7> columns_;
  std::size_t count_ = 0;
};

void merge(const AddedReturns& more, AddedReturns& all) {
  all.outside += more.outside;
  all.finite &= more.finite;
}

}  // namespace

BinAccumulator::BinAccumulator(const GridSpec& spec, Weights weights)
    : Accumulator(spec), weights_(weights), bins_(spec.size()), partition_(spec) {}

void BinAccumulator::add(const GridPoints& points, std::int64_t first_row_number) {
  std::size_t outside = 0;
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerPass) {
    const GridPoints piece = points.subset(begin, std::min(kPointsPerPass, points.size() - begin));
    const AddedReturns added =
        thread_count() == 1 ? add_returns(piece, spec(), weights_, bins_.values()) : add_piece(piece);
    if (!added.finite) throw_first_not_finite(piece, first_row_number + static_cast<std::int64_t>(begin));
    outside += added.outside;
  }
  count_points(points.size(), outside);
}

AddedReturns BinAccumulator::add_piece(const GridPoints& points) {
  partition_.assign(points.x_est, points.y_est);
  std::vector<AddedReturns> added(partition_.band_count() + 1);
  parallel_for(added.size(), 1, [&](std::size_t band, std::size_t) {
    added[band] = add_runs(points, partition_.runs_of_band(band));
  });
  AddedReturns all;
  for (const AddedReturns& of_band : added) merge(of_band, all);
  return all;
}

AddedReturns BinAccumulator::add_runs(const GridPoints& points, std::span<const PointRun> runs) {
  AddedReturns all;
  if (runs.empty()) return all;
  const std::span<BinSums> bins = bins_.values();
  GatheredRuns gathered;
  for (const PointRun run : runs) {
    const bool is_short = run.count < kShortRun;
    if (!is_short || !gathered.has_room(run.count)) {
      merge(add_returns(gathered.points(), spec(), weights_, bins), all);
      gathered.clear();
    }
    if (is_short) {
      gathered.append(points, run);
    } else {
      merge(add_returns(points.subset(run.begin, run.count), spec(), weights_, bins), all);
    }
  }
  merge(add_returns(gathered.points(), spec(), weights_, bins), all);
  return all;
}

void BinAccumulator::values(BinIndex first, std::span<BinValues> out) const {
  const std::span<const BinSums> sums = bins().subspan(spec().index(first), out.size());
  std::ranges::transform(sums, out.begin(), values_of);
}

}  // namespace landfall
