// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "base/raster/layer_check.h"
#include "base/raster/value_range.h"
#include "store/files/crs.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// The attributes of a layer. Units, long name and flags that are empty are those of the dictionary
/// (schemas/dictionary/layers.json).
struct LayerText {
  std::string units = {};
  std::string long_name = {};
  std::vector<std::int8_t> flag_values = {};
  std::string flag_meanings = {};
  std::vector<std::int8_t> flag_masks = {};    ///< bits that may be set together
  std::string ancillary_variables = {};        ///< layers that qualify this one's values, in CF's form
  std::string comment = {};                    ///< CF's comment
  std::optional<double> epoch_s = {};          ///< of a time: what the clock shows at 0
  std::optional<double> truth_spacing_m = {};  ///< of z_true: DemLayers::truth_spacing_m
};

/// The grid part of a file: coordinates /x and /y, /crs, and layers at the root (docs/user/files/README.md),
/// so that GDAL, GMT, ncdump, xarray, QGIS and ParaView open every layer georeferenced.
class GridLayerWriter {
 public:
  /// Writes /x, /y and /crs. `crs_wkt` is the site frame; `located_at` says what the coordinates refer to.
  /// The file makes no claim to CF if that cannot describe the frame.
  GridLayerWriter(LandfallFileWriter& file, const GridSpec& spec, const std::string& crs_wkt,
                  const std::string& located_at = "bin centre");

  /// T: double, float, std::int32_t or std::int8_t. Tiles are compressed in parallel. Throws IoError.
  template <class T>
  void write(const std::string& name, const Grid<T>& layer, const LayerText& text = {});

  /// A layer of T to be written in strips of rows, so that only part of it is in memory at a time.
  template <class T>
  [[nodiscard]] h5::Handle begin(const std::string& name, const LayerText& text = {}) const;
  /// Writes whole rows of the grid. The first row must be a multiple of 256 from the grid's first, and so
  /// must the end unless it is the grid's. Throws IoError.
  template <class T>
  void write_rows(const h5::Handle& layer, const std::string& name, const Grid<T>& rows) const;
  /// Writes the least and the greatest value of a layer that begin() created, as write() and write_tiled()
  /// do: the CF attribute actual_range, in the layer's type. A layer without values gets none.
  template <class T>
  static void write_range(const h5::Handle& layer, const ValueRange& range);

  /// One of several layers that are computed tile by tile.
  struct TiledLayer {
    std::string name;
    h5::Type type;  ///< float64, float32 or int32
    LayerText text = {};
  };
  /// The part of the grid that a tile covers, with fewer rows and columns at the grid's border; its rows of
  /// values begin `stride` apart.
  struct Tile {
    BinIndex first;
    std::int64_t rows;
    std::int64_t cols;
    std::int64_t stride;
  };
  using TileValues = std::variant<std::vector<double>, std::vector<float>, std::vector<std::int32_t>>;
  /// Writes a tile's values of every layer, in the order of the layers. Called for several tiles at once.
  using FillTile = std::function<void(const Tile& tile, std::span<TileValues> layers)>;
  /// Writes layers that are never in memory as a whole: tiles are computed and compressed on all threads,
  /// while earlier ones are written. Throws IoError.
  void write_tiled(const std::vector<TiledLayer>& layers, const FillTile& fill,
                   const ProgressCallback& progress = {});

 private:
  [[nodiscard]] h5::Handle create(const std::string& name, h5::Type type, const LayerText& given) const;
  [[nodiscard]] std::vector<Tile> tiles() const;
  void write_tile(hid_t dataset, const std::string& name, BinIndex first,
                  std::span<const std::byte> bytes) const;
  void attach_scales(const std::string& layer) const;

  hid_t root_;
  std::string kind_;
  int compression_;
  GridSpec spec_;
  CfFrame frame_;
};

/// Reads the grid of a file that GridLayerWriter wrote.
class GridLayerReader {
 public:
  /// Throws FormatError unless /x and /y are ascending, evenly spaced integer multiples of one resolution
  /// (within 1e-6 of a step).
  explicit GridLayerReader(const LandfallFileReader& file);

  [[nodiscard]] const GridSpec& spec() const { return spec_; }
  [[nodiscard]] const std::string& crs_wkt() const { return crs_wkt_; }
  [[nodiscard]] bool has(const std::string& name) const;
  /// Throws FormatError if the layer is missing, has another shape than (y, x), or cannot be read.
  template <class T>
  [[nodiscard]] Grid<T> read(const std::string& name, const ProgressCallback& progress = {}) const;
  /// As read(), and throws FormatError for the first value that is neither NaN nor allowed. T: double, float
  /// or std::int32_t.
  template <class T>
  [[nodiscard]] Grid<T> read_checked(const std::string& name, LayerValues allowed) const;
  /// The same of read_window(), of whole rows.
  [[nodiscard]] Grid<double> read_checked_rows(const std::string& name, LayerValues allowed,
                                               const GridSpec& rows) const;

  /// Size of the layer's chunks in bins, or a substitute for a layer without such chunks.
  [[nodiscard]] BinIndex tile() const;
  /// A part of a layer: bins of the grid; its first row and column are multiples of tile() from the grid's.
  /// Holds h5::library_lock(); its threads take no other tasks while they wait.
  template <class T>
  [[nodiscard]] Grid<T> read_window(const std::string& name, const GridSpec& window,
                                    const ProgressCallback& progress = {}) const;
  /// The same of any part of the grid: the tiles about it are read, because a part of one takes as long.
  [[nodiscard]] Grid<double> read_part(const std::string& name, const GridSpec& part) const;
  /// The range that write_range() wrote; nothing if a layer has none.
  [[nodiscard]] std::optional<std::array<double, 2>> range(const std::string& name) const;
  /// LayerText::truth_spacing_m of the layer z_true; nothing if it has none that is positive.
  [[nodiscard]] std::optional<double> truth_spacing_m() const;

 private:
  [[nodiscard]] h5::Handle open(const std::string& name) const;
  template <class T>
  void check(const Grid<T>& layer, const std::string& name, LayerValues allowed) const;

  const LandfallFileReader& file_;
  GridSpec spec_;
  std::string crs_wkt_;
};

}  // namespace landfall
