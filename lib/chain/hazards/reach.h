// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "base/raster/region.h"
#include "chain/hazards/lander.h"
#include "chain/hazards/padded_map.h"

namespace landfall {

/// The bins, relative to a place, on which its measures depend.
class Reach {
 public:
  /// Under the body.
  [[nodiscard]] static Reach of_body(const LanderStencil& lander);
  /// Under the body or, in any yaw, a pad.
  [[nodiscard]] static Reach of_contact(const LanderStencil& lander);

  /// In a square of 2 half_bins + 1 bins.
  [[nodiscard]] static Reach of_square(std::int64_t half_bins);

  /// The largest offset of a row or column.
  [[nodiscard]] std::int64_t bins() const { return bins_; }

  /// The bins of `places` of which every bin in reach is finite; the margin of `z` is at least bins().
  [[nodiscard]] BinMask known(const PaddedMap& z, const BinMask& places) const;

 private:
  /// The columns first .. last, inclusive, of a row.
  struct Span {
    std::int64_t row, first, last;
  };
  explicit Reach(std::vector<BinOffset> offsets);

  std::int64_t bins_ = 0;
  std::vector<Span> spans_;
};

}  // namespace landfall
