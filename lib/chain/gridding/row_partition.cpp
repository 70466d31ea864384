// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/gridding/row_partition.h"

#include <cassert>

namespace landfall {
namespace {

// A band of a 2001-column grid holds 1.3 MB of sums, which fits in a core's own cache; a scan that sweeps
// down the map still covers several bands in each batch.
constexpr std::int32_t kRowsPerBand = 8;
constexpr std::size_t kPointsPerPiece = 1U << 16U;

}  // namespace

RowPartition::RowPartition(const GridSpec& spec)
    : spec_(spec),
      band_count_(static_cast<std::size_t>((spec.rows + kRowsPerBand - 1) / kRowsPerBand)),
      band_begins_(band_count_ + 2, 0) {}

void RowPartition::assign(std::size_t count, const FindRows& find_rows) {
  assert(count <= kMaxPoints);
  const std::size_t pieces = (count + kPointsPerPiece - 1) / kPointsPerPiece;
  band_of_point_.resize(count);
  order_.resize(count);
  starts_.assign(pieces * (band_count_ + 1), 0);
  find_bands(find_rows);
  turn_counts_into_starts(pieces);
  scatter();
}

void RowPartition::assign(std::span<const double> x_m, std::span<const double> y_m) {
  assert(x_m.size() == y_m.size());
  assign(x_m.size(), [&](std::size_t begin, std::size_t end, std::int32_t* rows) {
    for (std::size_t i = begin; i < end; ++i) {
      const BinIndex bin = spec_.bin_of(x_m[i], y_m[i]);
      rows[i - begin] = spec_.contains(bin) ? static_cast<std::int32_t>(bin.row) : -1;
    }
  });
}

void RowPartition::find_bands(const FindRows& find_rows) {
  parallel_for(band_of_point_.size(), kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const counts = &starts_[slot(begin / kPointsPerPiece, 0)];
    find_rows(begin, end, &band_of_point_[begin]);
    for (std::size_t i = begin; i < end; ++i) {
      const std::int32_t row = band_of_point_[i];
      const bool inside = row >= 0 && row < spec_.rows;
      band_of_point_[i] = inside ? row / kRowsPerBand : static_cast<std::int32_t>(band_count_);
      ++counts[static_cast<std::size_t>(band_of_point_[i])];
    }
  });
}

void RowPartition::turn_counts_into_starts(std::size_t pieces) {
  std::uint32_t next = 0;
  for (std::size_t band = 0; band <= band_count_; ++band) {
    band_begins_[band] = next;
    for (std::size_t piece = 0; piece < pieces; ++piece) {
      const std::uint32_t count = starts_[slot(piece, band)];
      starts_[slot(piece, band)] = next;
      next += count;
    }
  }
  band_begins_[band_count_ + 1] = next;
}

void RowPartition::scatter() {
  parallel_for(band_of_point_.size(), kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    std::uint32_t* const starts = &starts_[slot(begin / kPointsPerPiece, 0)];
    for (std::size_t i = begin; i < end; ++i)
      order_[starts[static_cast<std::size_t>(band_of_point_[i])]++] = static_cast<std::uint32_t>(i);
  });
}

std::span<const std::uint32_t> RowPartition::points_of_band(std::size_t band) const {
  return std::span(order_).subspan(band_begins_[band], band_begins_[band + 1] - band_begins_[band]);
}

}  // namespace landfall
