// SPDX-License-Identifier: GPL-3.0-or-later
#include "gridding/run_partition.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "base/parallel.h"
#include "gridding/bin_kernel.h"

namespace landfall {
namespace {

constexpr std::int32_t kRowsPerBand = 8;  // as RowPartition
constexpr std::size_t kPointsPerPiece = 1U << 16U;
constexpr std::size_t kPointsPerLook = 512;

}  // namespace

RunPartition::RunPartition(const GridSpec& spec)
    : spec_(spec),
      band_count_(static_cast<std::size_t>((spec.rows + kRowsPerBand - 1) / kRowsPerBand)),
      band_begins_(band_count_ + 2, 0) {}

void RunPartition::assign(std::span<const double> x_m, std::span<const double> y_m) {
  assert(x_m.size() == y_m.size() && x_m.size() <= kMaxPoints);
  pieces_.resize((x_m.size() + kPointsPerPiece - 1) / kPointsPerPiece);
  parallel_for(x_m.size(), kPointsPerPiece, [&](std::size_t begin, std::size_t end) {
    Piece& piece = pieces_[begin / kPointsPerPiece];
    piece.runs.clear();
    piece.next.assign(band_count_ + 1, 0);
    std::array<std::int32_t, kPointsPerLook> rows;
    for (std::size_t at = begin; at < end; at += kPointsPerLook) {
      const std::size_t count = std::min(kPointsPerLook, end - at);
      find_rows(spec_, x_m.subspan(at, count), y_m.subspan(at, count), std::span(rows).first(count));
      find_runs(at, std::span(rows).first(count), piece);
    }
  });
  turn_counts_into_places();
  parallel_for(pieces_.size(), 1, [&](std::size_t i, std::size_t) {
    for (const BandRun& found : pieces_[i].runs) runs_[pieces_[i].next[found.band]++] = found.run;
  });
}

void RunPartition::find_runs(std::size_t begin, std::span<const std::int32_t> rows, Piece& piece) const {
  const auto outside = static_cast<std::uint32_t>(band_count_);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::uint32_t band = rows[i] < 0 ? outside : static_cast<std::uint32_t>(rows[i]) / kRowsPerBand;
    if (!piece.runs.empty() && piece.runs.back().band == band) {
      ++piece.runs.back().run.count;
    } else {
      piece.runs.push_back({band, {static_cast<std::uint32_t>(begin + i), 1}});
      ++piece.next[band];
    }
  }
}

void RunPartition::turn_counts_into_places() {
  std::uint32_t next = 0;
  for (std::size_t band = 0; band <= band_count_; ++band) {
    band_begins_[band] = next;
    for (Piece& piece : pieces_) {
      const std::uint32_t count = piece.next[band];
      piece.next[band] = next;
      next += count;
    }
  }
  band_begins_[band_count_ + 1] = next;
  runs_.resize(next);
}

std::span<const PointRun> RunPartition::runs_of_band(std::size_t band) const {
  return std::span(runs_).subspan(band_begins_[band], band_begins_[band + 1] - band_begins_[band]);
}

}  // namespace landfall
