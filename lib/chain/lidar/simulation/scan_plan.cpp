// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/lidar/simulation/scan_plan.h"

#include <cassert>
#include <limits>
#include <utility>

#include "base/core/error.h"

namespace landfall {

ScanPlan::ScanPlan(Grid<std::int8_t> region)
    : region_(std::move(region)),
      count_(region_.spec()),
      frames_(region_.spec()),
      first_seen_s_(region_.spec(), std::numeric_limits<float>::quiet_NaN()),
      last_pulse_(region_.spec(), -1) {}

void ScanPlan::add(const PulseBatch& batch) {
  const GridSpec& spec = region_.spec();
  std::size_t row = 0;
  for (std::size_t k = 0; k < batch.pulses.t.size(); ++k) {
    std::int64_t returns = 0;
    std::int64_t inside = 0;
    bool fired = false;
    for (const std::size_t end = row + static_cast<std::size_t>(batch.pulses.point_count[k]); row < end;
         ++row) {
      if (batch.points.status[row] != PointStatus::blanked && batch.points.status[row] != PointStatus::dead)
        fired = true;
      if (batch.points.status[row] != PointStatus::returned) continue;
      ++returns;
      const BinIndex bin = spec.bin_of(batch.points.x_true[row], batch.points.y_true[row]);
      if (!spec.contains(bin)) continue;
      inside += region_.at(bin);
      add_return(spec.index(bin), batch.points.pulse[row], batch.pulses.t[k]);
    }
    ++(!fired              ? pulses_.blanked
       : inside == 0       ? pulses_.off_region
       : inside == returns ? pulses_.in_region
                           : pulses_.partly_in_region);
    return_count_ += returns;
    region_return_count_ += inside;
  }
}

void ScanPlan::add_return(std::size_t bin, std::int32_t pulse, double since_start_s) {
  std::int32_t& count = count_.values()[bin];
  if (count == std::numeric_limits<std::int32_t>::max())
    throw FormatError(
        "a bin of the plan has more than 2147483647 returns; plan a shorter scan or finer bins");
  if (count++ == 0) first_seen_s_.values()[bin] = static_cast<float>(since_start_s);
  if (last_pulse_.values()[bin] == pulse) return;
  last_pulse_.values()[bin] = pulse;
  ++frames_.values()[bin];
}

ScanPlan plan_scan(const Simulation& simulation, Grid<std::int8_t> region, std::int64_t points_per_batch,
                   const ProgressCallback& progress) {
  ScanPlan plan(std::move(region));
  std::int64_t pulse = 0;
  const auto add = [&](PulseBatch& batch) {
    for (double& t_s : batch.pulses.t) t_s = simulation.since_start_s(pulse++);
    plan.add(batch);
    return SinkWork{};
  };
  run_scan(simulation, {}, add, points_per_batch, progress);
  return plan;
}

BinSpread spread_over_region(const Grid<std::int32_t>& values, const Grid<std::int8_t>& region) {
  std::vector<std::int64_t> bins_of;  // number of bins by value
  std::int64_t bins = 0;
  double sum = 0;
  for (std::size_t i = 0; i < region.values().size(); ++i) {
    if (region.values()[i] == 0) continue;
    const auto value = static_cast<std::size_t>(values.values()[i]);
    if (value >= bins_of.size()) bins_of.resize(value + 1);
    ++bins_of[value];
    ++bins;
    sum += static_cast<double>(value);
  }
  assert(bins > 0);
  const auto quantile = [&](double q) {
    std::int64_t below = 0;
    std::int64_t value = -1;
    while (static_cast<double>(below) < q * static_cast<double>(bins))
      below += bins_of[static_cast<std::size_t>(++value)];
    return value;
  };
  const std::int64_t at_most_one = bins_of[0] + (bins_of.size() > 1 ? bins_of[1] : 0);
  constexpr double kMin = 1e-300;  // selects the first bin
  return {.mean = sum / static_cast<double>(bins),
          .min = quantile(kMin),
          .p05 = quantile(0.05),
          .median = quantile(0.5),
          .p95 = quantile(0.95),
          .max = std::ssize(bins_of) - 1,
          .above_one_frac = 1 - static_cast<double>(at_most_one) / static_cast<double>(bins)};
}

namespace {

constexpr std::int64_t kMinBlocks = 100;

/// The number of set bins south and west of each bin, with one row and column more than the grid.
class SetBins {
 public:
  template <class T>
  explicit SetBins(const Grid<T>& grid)
      : width_(grid.spec().cols + 1), sums_(static_cast<std::size_t>(width_ * (grid.spec().rows + 1))) {
    for (std::int64_t row = 0; row < grid.spec().rows; ++row)
      for (std::int64_t col = 0; col < grid.spec().cols; ++col)
        sum(row + 1, col + 1) =
            (grid.at({row, col}) > 0 ? 1 : 0) + sum(row, col + 1) + sum(row + 1, col) - sum(row, col);
  }
  [[nodiscard]] std::int64_t in_block(BinIndex first, std::int64_t bins) const {
    const auto [row, col] = first;
    return sum(row + bins, col + bins) - sum(row, col + bins) - sum(row + bins, col) + sum(row, col);
  }

 private:
  [[nodiscard]] const std::int64_t& sum(std::int64_t row, std::int64_t col) const {
    return sums_[static_cast<std::size_t>(row * width_ + col)];
  }
  std::int64_t& sum(std::int64_t row, std::int64_t col) {
    return sums_[static_cast<std::size_t>(row * width_ + col)];
  }

  std::int64_t width_;
  std::vector<std::int64_t> sums_;
};

/// The first row or column of the grid at which a block about a multiple of `bins` begins.
std::int64_t first_block(std::int64_t first, std::int64_t bins) {
  const std::int64_t past = (first + bins / 2) % bins;
  return (bins - (past + bins) % bins) % bins;
}

struct BlockCounts {
  std::int64_t all = 0, filled = 0;
};

BlockCounts count_blocks(const SetBins& inside, const SetBins& seen, const GridSpec& spec,
                         std::int64_t bins) {
  BlockCounts blocks;
  for (std::int64_t row = first_block(spec.first_row, bins); row + bins <= spec.rows; row += bins)
    for (std::int64_t col = first_block(spec.first_col, bins); col + bins <= spec.cols; col += bins) {
      if (inside.in_block({row, col}, bins) < bins * bins) continue;
      ++blocks.all;
      if (seen.in_block({row, col}, bins) > 0) ++blocks.filled;
    }
  return blocks;
}

}  // namespace

std::optional<FilledPosting> finest_posting(const Grid<std::int32_t>& count, const Grid<std::int8_t>& region,
                                            double filled_frac) {
  const SetBins inside(region);
  const SetBins seen(count);
  for (std::int64_t bins = 1;; ++bins) {
    const BlockCounts blocks = count_blocks(inside, seen, region.spec(), bins);
    if (blocks.all < kMinBlocks) return std::nullopt;
    const double share = static_cast<double>(blocks.filled) / static_cast<double>(blocks.all);
    if (share >= filled_frac) return FilledPosting{bins, share};
  }
}

}  // namespace landfall
