// SPDX-License-Identifier: GPL-3.0-or-later
// Layers are stored tile by tile, all layers of a tile together, so that the data they are computed from
// is read once. A reader sees no difference.
#include "store/hdf5/grid_tiles.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <span>
#include <vector>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/raster/by_rows.h"
#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/chunk_source.h"
#include "store/hdf5/memory_file.h"

namespace landfall {
namespace {

using tbb::filter_mode;

constexpr std::int64_t kTile = 256;

/// Iterates over the tiles of a grid in row-major order, one per call.
class TileSequence {
 public:
  TileSequence(const GridSpec& spec, BinIndex tile) : spec_(spec), tile_(tile) {}

  [[nodiscard]] bool at_end() const { return next_.row >= spec_.rows; }

  /// The fraction of the layer's rows that have been returned.
  [[nodiscard]] double fraction() const {
    return static_cast<double>(std::min(next_.row, spec_.rows)) / static_cast<double>(spec_.rows);
  }

  /// The first bin of the next tile; must not be called at the end.
  BinIndex next() {
    const BinIndex first = next_;
    next_.col += tile_.col;
    if (next_.col >= spec_.cols) next_ = {next_.row + tile_.row, 0};
    return first;
  }

 private:
  GridSpec spec_;
  BinIndex tile_;
  BinIndex next_;
};

/// Tiles in progress per thread.
constexpr std::size_t kTilesPerThread = 4;

/// Converts a bin of the part to its offset in the layer.
std::array<hsize_t, 2> offset_of(const LayerPart& part, BinIndex bin) {
  return {static_cast<hsize_t>(part.first.row + bin.row), static_cast<hsize_t>(part.first.col + bin.col)};
}

/// The tile that begins at this bin, padded with the fill value to a full chunk.
template <class T>
void copy_tile(const Grid<T>& layer, BinIndex tile, BinIndex first, std::vector<T>& values) {
  const std::int64_t rows = std::min(tile.row, layer.spec().rows - first.row);
  const std::int64_t cols = std::min(tile.col, layer.spec().cols - first.col);
  const auto bins = static_cast<std::size_t>(tile.row * tile.col);
  if (rows < tile.row || cols < tile.col)
    values.assign(bins, fill_of<T>());
  else
    values.resize(bins);
  for (std::int64_t r = 0; r < rows; ++r)
    std::memcpy(values.data() + r * tile.col, &layer.at({first.row + r, first.col}),
                static_cast<std::size_t>(cols) * sizeof(T));
}

struct LoadedTile {
  BinIndex first;
  StoredChunk chunk;
};

/// Decodes the tile into `values` and copies the bins that lie in the layer.
template <class T>
bool place_tile(const LoadedTile& loaded, BinIndex tile, const ChunkFormat& format, std::vector<T>& values,
                Grid<T>& layer) {
  values.resize(format.element_count);
  if (!decode_chunk(loaded.chunk.bytes, loaded.chunk.filter_mask, format, 0,
                    std::as_writable_bytes(std::span(values))))
    return false;
  const std::int64_t rows = std::min(tile.row, layer.spec().rows - loaded.first.row);
  const std::int64_t cols = std::min(tile.col, layer.spec().cols - loaded.first.col);
  for (std::int64_t r = 0; r < rows; ++r)
    std::copy_n(values.begin() + r * tile.col, cols, &layer.at({loaded.first.row + r, loaded.first.col}));
  return true;
}

/// Copies a part of a layer in memory. False if that has another type.
template <class T>
bool copy_part(const h5::MemoryArray& array, const LayerPart& part, Grid<T>& layer) {
  if (array.type != h5::TypeOf<T>::value) return false;
  by_rows(layer.spec(), [&](std::int64_t row) {
    const auto [first_row, first_col] = offset_of(part, {row, 0});
    std::memcpy(&layer.at({row, 0}),
                array.values.data() + (first_row * array.shape[1] + first_col) * sizeof(T),
                static_cast<std::size_t>(layer.spec().cols) * sizeof(T));
  });
  return true;
}

}  // namespace

BinIndex tile_of(const GridSpec& spec) { return {std::min(kTile, spec.rows), std::min(kTile, spec.cols)}; }

// HDF5 is not reentrant: only one stage of each pipeline calls it, in order.

template <class T>
void write_tiles(hid_t dataset, const Grid<T>& values, const LayerPart& part, int compression,
                 const std::string& name) {
  std::vector<BinIndex> todo;
  for (TileSequence tiles(values.spec(), part.tile); !tiles.at_end();) todo.push_back(tiles.next());
  struct Slot {
    ChunkEncoder encoder;
    std::vector<T> values;
    std::span<const std::byte> bytes;
  };
  std::vector<Slot> slots(kTilesPerThread * thread_count(), {ChunkEncoder(sizeof(T), compression), {}, {}});
  const auto encode = [&](std::size_t i, std::size_t number) {
    Slot& slot = slots[number];
    copy_tile(values, part.tile, todo[i], slot.values);
    slot.bytes = slot.encoder.encode(std::as_bytes(std::span(slot.values)));
  };
  const auto write = [&](std::size_t i, std::size_t number) {
    if (!h5::write_chunk(dataset, offset_of(part, todo[i]), slots[number].bytes))
      throw IoError("writing layer " + name + " failed: " + h5::failure_reason());
  };
  produce_in_parallel(todo.size(), slots.size(), encode, write);
}

template <class T>
bool read_tiles(hid_t dataset, Grid<T>& layer, const LayerPart& part, const ProgressCallback& progress) {
  if (const auto array = h5::array_in_memory(dataset)) return copy_part(*array, part, layer);
  const auto chunks = decodable_chunks(dataset, offset_of({}, part.tile));
  if (!chunks || chunks->type != h5::TypeOf<T>::value) return false;
  TileSequence tiles(layer.spec(), part.tile);
  std::atomic<bool> good = true;
  const auto load = [&](tbb::flow_control& control) {
    LoadedTile loaded;
    if (tiles.at_end() || !good) {
      control.stop();
      return loaded;
    }
    report(progress, tiles.fraction());
    loaded.first = tiles.next();
    // A missing tile is handled like one that cannot be decoded.
    if (!load_chunk(dataset, offset_of(part, loaded.first), loaded.chunk)) good = false;
    return loaded;
  };
  tbb::enumerable_thread_specific<std::vector<T>> values;  // kept from tile to tile
  const auto scatter = [&](const LoadedTile& loaded) {
    if (!place_tile(loaded, part.tile, chunks->format, values.local(), layer)) good = false;
  };
  tbb::parallel_pipeline(kTilesPerThread * thread_count(),
                         tbb::make_filter<void, LoadedTile>(filter_mode::serial_in_order, load) &
                             tbb::make_filter<LoadedTile, void>(filter_mode::parallel, scatter));
  return good;
}

template void write_tiles(hid_t, const Grid<double>&, const LayerPart&, int, const std::string&);
template void write_tiles(hid_t, const Grid<float>&, const LayerPart&, int, const std::string&);
template void write_tiles(hid_t, const Grid<std::int32_t>&, const LayerPart&, int, const std::string&);
template void write_tiles(hid_t, const Grid<std::int8_t>&, const LayerPart&, int, const std::string&);
template bool read_tiles(hid_t, Grid<double>&, const LayerPart&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<float>&, const LayerPart&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<std::int32_t>&, const LayerPart&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<std::int8_t>&, const LayerPart&, const ProgressCallback&);

}  // namespace landfall
