// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/draws/draw_gridder.h"

#include <algorithm>
#include <memory>
#include <type_traits>

#include "base/core/parallel.h"

namespace landfall {
namespace {

/// Points that a pass makes and grids: on one thread as many as stay in its cache of the second level in
/// between, on several enough that the pass costs more than its start.
std::int64_t points_per_pass() { return std::int64_t{1} << (thread_count() == 1 ? 14U : 17U); }
constexpr std::int64_t kPointsPerDrawPiece = 8192;

/// Memory for every bin; its values are not set.
void require_layers(DrawnDem& dem, const GridSpec& grid) {
  const auto require = [&](auto& layer) {
    if (layer.spec() != grid) layer = std::remove_reference_t<decltype(layer)>::unset(grid);
  };
  if (!dem.layers.truth) dem.layers.truth.emplace();
  require(dem.layers.z_est);
  require(dem.layers.truth->x);
  require(dem.layers.truth->y);
  require(dem.layers.truth->z);
  require(dem.count);
}

}  // namespace

DrawGridder::DrawGridder(const TrueRanges& truth, const GridSpec& grid,
                         const std::optional<OpenClOptions>& device)
    : truth_(truth), grid_(grid) {
  if (device) device_ = std::make_unique<DeviceGridder>(truth, grid, *device);
}

void DrawGridder::take_values(const ReadBins& read, TruthAt truth_at, const TerrainSurface& truth,
                              DrawnDem& dem) const {
  require_layers(dem, grid_);
  const auto elevation = [&](double x_m, double y_m) { return truth.elevation(x_m, y_m); };
  parallel_for(static_cast<std::size_t>(grid_.rows), 16, [&](std::size_t begin, std::size_t end) {
    std::vector<BinValues> row(static_cast<std::size_t>(grid_.cols));
    for (auto r = static_cast<std::int64_t>(begin); r < static_cast<std::int64_t>(end); ++r) {
      read({r, 0}, row);
      for (std::int64_t c = 0; c < grid_.cols; ++c) {
        const BinIndex bin{r, c};
        const BinValues& values = row[static_cast<std::size_t>(c)];
        dem.layers.z_est.at(bin) = values.z_est;
        dem.layers.truth->x.at(bin) = values.x_true;
        dem.layers.truth->y.at(bin) = values.y_true;
        dem.layers.truth->z.at(bin) = true_elevation(values, grid_, bin, elevation, truth_at);
        dem.count.at(bin) = values.count;
      }
    }
  });
}

void DrawGridder::draw(const Simulation& simulation, Method method, TruthAt truth_at,
                       const TerrainSurface& truth, DrawnDem& dem) {
  if (device_ && device_->draw(simulation, method)) {
    const auto read = [this](BinIndex first, std::span<BinValues> out) { device_->values(first, out); };
    return take_values(read, truth_at, truth, dem);
  }
  Accumulator& bins = empty_bins(method);
  const auto rows = static_cast<std::int64_t>(simulation.rows_per_pulse());
  const std::int64_t pulses_per_pass = std::max<std::int64_t>(1, points_per_pass() / rows);
  do {
    for (std::int64_t first = 0; first < simulation.pulse_count(); first += pulses_per_pass) {
      fill(simulation, {first, std::min(pulses_per_pass, simulation.pulse_count() - first)});
      bins.add(points());
    }
  } while (bins.end_pass());
  const auto read = [&](BinIndex first, std::span<BinValues> out) { bins.take_values(first, out); };
  take_values(read, truth_at, truth, dem);
  are_empty_ = bins.forgets();
}

Accumulator& DrawGridder::empty_bins(Method method) {
  if (!are_empty_ || method != method_) {
    bins_.reset();  // the old bins first, so that both never exist at once
    bins_ = make_accumulator(method, grid_);
    method_ = method;
  }
  are_empty_ = false;
  bins_->restart();
  return *bins_;
}

void DrawGridder::fill(const Simulation& simulation, PulseSpan pulses) {
  const std::size_t rows = simulation.rows_per_pulse();
  batch_.resize(static_cast<std::size_t>(pulses.count), rows, PointContent::places, simulation.columns());
  const std::int64_t per_piece =
      std::max<std::int64_t>(1, kPointsPerDrawPiece / static_cast<std::int64_t>(rows));
  parallel_for(static_cast<std::size_t>((pulses.count + per_piece - 1) / per_piece), 1,
               [&](std::size_t begin, std::size_t end) {
                 const std::int64_t slot = static_cast<std::int64_t>(begin) * per_piece;
                 const std::int64_t count =
                     std::min(static_cast<std::int64_t>(end) * per_piece, pulses.count) - slot;
                 fill_slots(simulation, {pulses.first + slot, count}, static_cast<std::size_t>(slot));
               });
}

void DrawGridder::fill_slots(const Simulation& simulation, PulseSpan pulses, std::size_t first_slot) {
  if (simulation.can_trace()) return simulation.simulate_slots(pulses, first_slot, batch_);
  const std::size_t pixels = simulation.pixel_count();
  const TrueRanges seen = truth_.part(static_cast<std::size_t>(pulses.first) * pixels,
                                      static_cast<std::size_t>(pulses.count) * pixels);
  simulation.replay_slots(pulses, seen, first_slot, batch_);
}

GridPoints DrawGridder::points() {
  no_times_.resize(batch_.points.size());
  return GridPoints::of(batch_.points, no_times_);
}

}  // namespace landfall
