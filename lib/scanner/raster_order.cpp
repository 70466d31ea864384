// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanner/raster_order.h"

#include "base/parameter_check.h"

namespace landfall {
namespace {

constexpr int kMaxLines = 1 << 20;

}  // namespace

void check_raster(const RasterOrder& order) {
  require(order.rows >= 1 && order.rows <= kMaxLines, {"", "rows"}, order.rows, "in 1..1048576");
  require(order.columns >= 1 && order.columns <= kMaxLines, {"", "columns"}, order.columns, "in 1..1048576");
}

std::int64_t raster_steps(const RasterOrder& order) { return std::int64_t{order.rows} * order.columns; }

std::optional<RasterPlace> raster_place(const RasterOrder& order, std::int64_t step) {
  const std::int64_t count = raster_steps(order);
  if (order.at_end == AtEnd::stop && step >= count) return std::nullopt;
  const std::int64_t in_pass = step % count;
  const std::int64_t row = in_pass / order.columns;
  const std::int64_t place = in_pass % order.columns;
  const bool backwards = order.direction == LineDirection::boustrophedon && row % 2 == 1;
  return RasterPlace{row, backwards ? order.columns - 1 - place : place, in_pass};
}

std::optional<PatternJump> jump_to_piece(const PulseTime& pulse, std::int64_t length) {
  const std::int64_t first = pulse.pulse - pulse.pulse % length;
  if (first == 0) return std::nullopt;
  const double interval_s = pulse.since_start_s / static_cast<double>(pulse.pulse);
  return PatternJump{static_cast<double>(pulse.pulse - first) * interval_s,
                     {first - 1, static_cast<double>(first - 1) * interval_s}};
}

}  // namespace landfall
