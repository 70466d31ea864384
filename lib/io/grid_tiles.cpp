// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/grid_tiles.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/parallel.h"
#include "io/chunk_codec.h"
#include "io/chunk_source.h"

namespace landfall {
namespace {

using tbb::filter_mode;

constexpr std::int64_t kTile = 256;

/// The tiles of a layer in row-major order, one call after another.
class TileSequence {
 public:
  explicit TileSequence(const GridSpec& spec) : spec_(spec), tile_(tile_of(spec)) {}

  [[nodiscard]] bool at_end() const { return next_.row >= spec_.rows; }

  /// The part of the layer's rows that have been given out.
  [[nodiscard]] double fraction() const {
    return static_cast<double>(std::min(next_.row, spec_.rows)) / static_cast<double>(spec_.rows);
  }

  /// The first bin of the next tile; not at the end.
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

/// Tiles under way for each thread.
constexpr std::size_t kTilesPerThread = 4;

std::array<hsize_t, 2> offset_of(BinIndex first) {
  return {static_cast<hsize_t>(first.row), static_cast<hsize_t>(first.col)};
}

/// The tile of this first bin, padded with the fill value to a full chunk.
template <class T>
void copy_tile(const Grid<T>& layer, BinIndex first, std::vector<T>& values) {
  const BinIndex tile = tile_of(layer.spec());
  values.assign(static_cast<std::size_t>(tile.row * tile.col), fill_of<T>());
  const std::int64_t rows = std::min(tile.row, layer.spec().rows - first.row);
  const std::int64_t cols = std::min(tile.col, layer.spec().cols - first.col);
  for (std::int64_t r = 0; r < rows; ++r)
    std::memcpy(values.data() + r * tile.col, &layer.at({first.row + r, first.col}),
                static_cast<std::size_t>(cols) * sizeof(T));
}

/// One thread's memory, kept from tile to tile.
template <class T>
struct TileEncoder {
  ChunkEncoder encoder;
  std::vector<T> values;
};

struct EncodedTile {
  BinIndex first;
  std::vector<std::byte> bytes;
};

struct LoadedTile {
  BinIndex first;
  StoredChunk chunk;
};

/// Decodes the tile and puts the bins that lie in the layer in their place.
template <class T>
bool place_tile(const LoadedTile& loaded, const ChunkFormat& format, Grid<T>& layer) {
  const BinIndex tile = tile_of(layer.spec());
  std::vector<T> values(format.element_count);
  if (!decode_chunk(loaded.chunk.bytes, loaded.chunk.filter_mask, format, 0,
                    std::as_writable_bytes(std::span(values))))
    return false;
  const std::int64_t rows = std::min(tile.row, layer.spec().rows - loaded.first.row);
  const std::int64_t cols = std::min(tile.col, layer.spec().cols - loaded.first.col);
  for (std::int64_t r = 0; r < rows; ++r)
    std::copy_n(values.begin() + r * tile.col, cols, &layer.at({loaded.first.row + r, loaded.first.col}));
  return true;
}

}  // namespace

BinIndex tile_of(const GridSpec& spec) { return {std::min(kTile, spec.rows), std::min(kTile, spec.cols)}; }

// HDF5 is not reentrant: one stage of each pipeline calls it, in order.

template <class T>
void write_tiles(hid_t dataset, const Grid<T>& layer, int compression, const std::string& name) {
  TileSequence tiles(layer.spec());
  const auto next = [&](tbb::flow_control& control) {
    if (!tiles.at_end()) return tiles.next();
    control.stop();
    return BinIndex{};
  };
  tbb::enumerable_thread_specific<TileEncoder<T>> encoders([&] {
    return TileEncoder<T>{ChunkEncoder(sizeof(T), compression), {}};
  });
  const auto encode = [&](BinIndex first) {
    auto& [encoder, values] = encoders.local();
    copy_tile(layer, first, values);
    const auto bytes = encoder.encode(std::as_bytes(std::span(values)));
    return EncodedTile{first, {bytes.begin(), bytes.end()}};
  };
  const auto write = [&](const EncodedTile& encoded) {
    if (H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, offset_of(encoded.first).data(), encoded.bytes.size(),
                       encoded.bytes.data()) < 0)
      throw IoError("writing layer " + name + " failed: " + h5::failure_reason());
  };
  tbb::parallel_pipeline(kTilesPerThread * thread_count(),
                         tbb::make_filter<void, BinIndex>(filter_mode::serial_in_order, next) &
                             tbb::make_filter<BinIndex, EncodedTile>(filter_mode::parallel, encode) &
                             tbb::make_filter<EncodedTile, void>(filter_mode::serial_in_order, write));
}

template <class T>
bool read_tiles(hid_t dataset, Grid<T>& layer, const ProgressCallback& progress) {
  const auto chunks = decodable_chunks(dataset, offset_of(tile_of(layer.spec())));
  if (!chunks || chunks->type != h5::TypeOf<T>::value) return false;
  TileSequence tiles(layer.spec());
  std::atomic<bool> good = true;
  const auto load = [&](tbb::flow_control& control) {
    LoadedTile loaded;
    if (tiles.at_end() || !good) {
      control.stop();
      return loaded;
    }
    report(progress, tiles.fraction());
    loaded.first = tiles.next();
    // A tile that is not there is like one that cannot be decoded.
    if (!load_chunk(dataset, offset_of(loaded.first), loaded.chunk)) good = false;
    return loaded;
  };
  const auto place = [&](const LoadedTile& loaded) {
    if (!place_tile(loaded, chunks->format, layer)) good = false;
  };
  tbb::parallel_pipeline(kTilesPerThread * thread_count(),
                         tbb::make_filter<void, LoadedTile>(filter_mode::serial_in_order, load) &
                             tbb::make_filter<LoadedTile, void>(filter_mode::parallel, place));
  return good;
}

template void write_tiles(hid_t, const Grid<double>&, int, const std::string&);
template void write_tiles(hid_t, const Grid<float>&, int, const std::string&);
template void write_tiles(hid_t, const Grid<std::int32_t>&, int, const std::string&);
template void write_tiles(hid_t, const Grid<std::int8_t>&, int, const std::string&);
template bool read_tiles(hid_t, Grid<double>&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<float>&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<std::int32_t>&, const ProgressCallback&);
template bool read_tiles(hid_t, Grid<std::int8_t>&, const ProgressCallback&);

}  // namespace landfall
