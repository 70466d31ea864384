// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/hazards/reach.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/raster/by_rows.h"

namespace landfall {
namespace {

void add(const Footprint& footprint, const BinOffset& centre, std::vector<BinOffset>& offsets) {
  for (std::int64_t row = -footprint.half_bins(); row <= footprint.half_bins(); ++row)
    for (std::int64_t col = -footprint.half_width(row); col <= footprint.half_width(row); ++col)
      offsets.push_back({centre.rows + row, centre.cols + col});
}

}  // namespace

Reach Reach::of_body(const LanderStencil& lander) {
  std::vector<BinOffset> offsets;
  add(lander.body, {}, offsets);
  return Reach(std::move(offsets));
}

Reach Reach::of_contact(const LanderStencil& lander) {
  std::vector<BinOffset> offsets;
  add(lander.body, {}, offsets);
  for (const PadOffsets& pads : lander.yaws)
    for (int leg = 0; leg < lander.legs; ++leg) add(lander.pad, pads[static_cast<std::size_t>(leg)], offsets);
  return Reach(std::move(offsets));
}

Reach Reach::of_square(std::int64_t half_bins) {
  std::vector<BinOffset> offsets;
  add(Footprint::square(half_bins), {}, offsets);
  return Reach(std::move(offsets));
}

Reach::Reach(std::vector<BinOffset> offsets) {
  std::ranges::sort(offsets, [](const BinOffset& a, const BinOffset& b) {
    return a.rows != b.rows ? a.rows < b.rows : a.cols < b.cols;
  });
  for (const BinOffset& bin : offsets) {
    bins_ = std::max({bins_, std::abs(bin.rows), std::abs(bin.cols)});
    if (!spans_.empty() && spans_.back().row == bin.rows && bin.cols <= spans_.back().last + 1)
      spans_.back().last = std::max(spans_.back().last, bin.cols);
    else
      spans_.push_back({bin.rows, bin.cols, bin.cols});
  }
}

BinMask Reach::known(const PaddedMap& z, const BinMask& places) const {
  // For each row, the number of bins without a value before a column: a span holds none if it adds nothing.
  const std::int64_t margin = z.margin();
  const std::int64_t width = z.cols() + 2 * margin + 1;
  const std::int64_t height = z.rows() + 2 * margin;
  std::vector<std::int32_t, LargeAllocator<std::int32_t>> missing(static_cast<std::size_t>(width * height));
  by_rows(height, [&](std::int64_t i) {
    const double* const values = z.at(i - margin, -margin);
    std::int32_t* const row = &missing[static_cast<std::size_t>(i * width)];
    row[0] = 0;
    for (std::int64_t c = 0; c + 1 < width; ++c) row[c + 1] = row[c] + (std::isfinite(values[c]) ? 0 : 1);
  });
  BinMask known(places.spec());
  by_rows(z.rows(), [&](std::int64_t row) {
    const std::span<std::int8_t> target = known.row(row);
    if (std::ranges::none_of(places.row(row), [](std::int8_t place) { return place != 0; })) return;
    std::ranges::copy(places.row(row), target.begin());
    for (const Span& span : spans_) {
      const std::int32_t* const counts =
          &missing[static_cast<std::size_t>((row + span.row + margin) * width + margin)];
      for (std::size_t c = 0; c < target.size(); ++c) {
        const std::int32_t* const at = counts + c;
        target[c] &= at[span.last + 1] == at[span.first] ? std::int8_t{1} : std::int8_t{0};
      }
    }
  });
  return known;
}

}  // namespace landfall
