// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <limits>
#include <string>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// A layer's chunks: 256 x 256 bins, fewer in a smaller grid.
[[nodiscard]] BinIndex tile_of(const GridSpec& spec);

/// The position of a grid within the layer that contains it.
struct LayerPart {
  BinIndex tile;   ///< the layer's chunks
  BinIndex first;  ///< bin of the layer: row and column are multiples of `tile`
};

/// The fill value of a layer: NaN, or 0 for integers.
template <class T>
constexpr T fill_of() {
  if constexpr (std::numeric_limits<T>::has_quiet_NaN) return std::numeric_limits<T>::quiet_NaN();
  return T{0};
}

/// Writes all tiles of a part of a layer to its dataset, which has chunks of part.tile with shuffle and
/// deflate at the level `compression`, or deflate alone at level 0. Tiles are compressed on all threads and
/// written in row-major order. The part must end with a tile or with the layer. Throws IoError naming the
/// layer.
template <class T>
void write_tiles(hid_t dataset, const Grid<T>& values, const LayerPart& part, int compression,
                 const std::string& name);

/// Reads all tiles of a part of a layer that write_tiles() can write, decoding them on all threads. Returns
/// false, with `layer` unspecified, for any other dataset of this shape and if a tile is missing or damaged:
/// h5::read_values() handles these. The progress is the fraction of the rows loaded so far; it stays below 1.
template <class T>
[[nodiscard]] bool read_tiles(hid_t dataset, Grid<T>& layer, const LayerPart& part,
                              const ProgressCallback& progress = {});

}  // namespace landfall
