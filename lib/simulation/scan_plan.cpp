// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/scan_plan.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"

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

}  // namespace landfall
