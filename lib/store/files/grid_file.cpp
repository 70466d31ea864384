// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D248
#include "store/files/grid_file.h"

#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/dictionary/layers.h"
#include "base/text/number_text.h"
#include "store/hdf5/chunk_codec.h"
#include "store/hdf5/grid_tiles.h"
#include "store/hdf5/infinite_values.h"
#include "store/hdf5/memory_file.h"

namespace landfall {
namespace {

constexpr const char* kTruthSpacing = "truth_spacing_m";  ///< attribute of z_true

/// `count` fill values of the layer's type.
void prepare(GridLayerWriter::TileValues& values, h5::Type type, std::size_t count) {
  const auto fill = [&]<class T>(T value) {
    if (!std::holds_alternative<std::vector<T>>(values)) values = std::vector<T>();
    std::get<std::vector<T>>(values).assign(count, value);
  };
  if (type == h5::Type::float64) return fill(fill_of<double>());
  if (type == h5::Type::float32) return fill(fill_of<float>());
  if (type == h5::Type::int32) return fill(fill_of<std::int32_t>());
  throw std::logic_error("no tiles of this type");
}

void write_axis(hid_t root, const char* name, const std::vector<double>& values,
                const std::string& located_at) {
  const std::string axis = name;
  const h5::Handle dataset =
      h5::create_dataset(root, axis, h5::Type::float64, {.size = {values.size()}, .chunk = {}});
  if (H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    throw IoError("writing /" + axis + " failed: " + h5::failure_reason());
  H5DSset_scale(dataset.get(), name);
  h5::write_attribute(dataset.get(), "units", std::string("m"));
  h5::write_attribute(dataset.get(), "long_name", axis + " in the DEM frame, " + located_at);
  h5::write_attribute(dataset.get(), "standard_name", "projection_" + axis + "_coordinate");
  h5::write_attribute(dataset.get(), "axis", std::string(axis == "x" ? "X" : "Y"));
}

void write_actual_range(hid_t dataset, h5::Type type, const ValueRange& range) {
  if (const auto pair = range.pair()) h5::write_attribute(dataset, "actual_range", type, *pair);
}

/// The range of a tile's values; the padding at the grid's border does not count.
ValueRange range_of(const GridLayerWriter::Tile& tile, const GridLayerWriter::TileValues& values) {
  ValueRange range;
  std::visit(
      [&]<class T>(const std::vector<T>& v) {
        for (std::int64_t r = 0; r < tile.rows; ++r)
          range.add(std::span<const T>(v).subspan(static_cast<std::size_t>(r * tile.stride),
                                                  static_cast<std::size_t>(tile.cols)));
      },
      values);
  return range;
}

/// _FillValue as netCDF writes it: one element of the layer's own type.
void write_fill_value(hid_t dataset, h5::Type type) {
  const hsize_t one = 1;
  const h5::Handle space(H5Screate_simple(1, &one, nullptr), H5Sclose);
  const h5::Handle attribute(
      H5Acreate2(dataset, "_FillValue", h5::native(type), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, &nan);
}

std::vector<double> read_axis(const LandfallFileReader& file, const std::string& name) {
  const h5::Handle dataset = h5::open_dataset(file.root(), name);
  if (!dataset) file.fail("no dataset /" + name);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (H5Sget_simple_extent_ndims(space.get()) != 1 || count < 2 || count > (hssize_t{1} << 30U))
    file.fail("/" + name + " is not a list of 2 to 2^30 coordinates");
  std::vector<double> values(static_cast<std::size_t>(count));
  if (!h5::read_values(dataset.get(), H5T_NATIVE_DOUBLE, values.data()))
    file.fail("reading /" + name + " failed: " + h5::reading_failure());
  return values;
}

/// The resolution: the file's own value if it agrees with the coordinates, else their mean step.
double resolution_of(const LandfallFileReader& file, const std::vector<double>& x) {
  const double step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  const double stated = h5::read_number_attribute(file.root(), "resolution_m").value_or(step);
  if (!(step > 0) || !std::isfinite(step)) file.fail("/x is not ascending");
  return std::abs(stated - step) <= 1e-9 * step ? stated : step;
}

std::int64_t first_index(const LandfallFileReader& file, const std::vector<double>& axis, double resolution_m,
                         const std::string& name) {
  const double first = std::nearbyint(axis.front() / resolution_m);
  if (!(std::abs(first) <= 0x1p40)) file.fail("/" + name + "[0] is not near the site");
  for (std::size_t i = 0; i < axis.size(); ++i) {
    const double expected = (first + static_cast<double>(i)) * resolution_m;
    if (!(std::abs(axis[i] - expected) <= 1e-6 * resolution_m))
      file.fail("/" + name + "[" + std::to_string(i) + "] = " + number_text(axis[i]) +
                " is not an integer multiple of the resolution " + number_text(resolution_m));
  }
  return static_cast<std::int64_t>(first);
}

/// Reads any stored layer through HDF5.
bool read_rectangle(hid_t dataset, hid_t type, BinIndex first, const GridSpec& window, void* values) {
  const hsize_t start[2] = {static_cast<hsize_t>(first.row), static_cast<hsize_t>(first.col)};
  const hsize_t count[2] = {static_cast<hsize_t>(window.rows), static_cast<hsize_t>(window.cols)};
  return h5::read_block(dataset, type, start, count, values);
}

GridSpec read_spec(const LandfallFileReader& file) {
  const std::vector<double> x = read_axis(file, "x");
  const std::vector<double> y = read_axis(file, "y");
  GridSpec spec;
  spec.resolution_m = resolution_of(file, x);
  spec.first_col = first_index(file, x, spec.resolution_m, "x");
  spec.first_row = first_index(file, y, spec.resolution_m, "y");
  spec.cols = static_cast<std::int64_t>(x.size());
  spec.rows = static_cast<std::int64_t>(y.size());
  return spec;
}

void complete(std::string& text, const char* words) {
  if (text.empty()) text = words;
}

LayerText completed(const std::string& kind, const std::string& name, LayerText text) {
  const dictionary::Layer* const layer = dictionary::find_layer(kind, name);
  if (layer == nullptr) return text;
  complete(text.units, layer->unit);
  complete(text.long_name, layer->long_name);
  complete(text.flag_meanings, layer->flag_meanings);
  if (text.flag_meanings.empty() || !text.flag_values.empty() || !text.flag_masks.empty()) return text;
  const auto spaces = std::ranges::count(text.flag_meanings, ' ');
  for (std::int8_t value = 0; value <= spaces; ++value) text.flag_values.push_back(value);
  return text;
}

}  // namespace

GridLayerWriter::GridLayerWriter(LandfallFileWriter& file, const GridSpec& spec, const std::string& crs_wkt,
                                 const std::string& located_at)
    : root_(file.root()), kind_(file.kind()), compression_(file.compression()), spec_(spec) {
  std::vector<double> x(static_cast<std::size_t>(spec.cols));
  std::vector<double> y(static_cast<std::size_t>(spec.rows));
  for (std::int64_t c = 0; c < spec.cols; ++c) x[static_cast<std::size_t>(c)] = spec.x(c);
  for (std::int64_t r = 0; r < spec.rows; ++r) y[static_cast<std::size_t>(r)] = spec.y(r);
  h5::write_attribute(root_, "resolution_m", spec.resolution_m);
  write_axis(root_, "x", x, located_at);
  write_axis(root_, "y", y, located_at);
  frame_ = write_crs(root_, crs_wkt);
  if (frame_ == CfFrame::inexpressible) file.withdraw_cf_claim();
}

/// netCDF then knows the axes of a layer.
void GridLayerWriter::attach_scales(const std::string& layer) const {
  h5::for_other_programs(root_, [layer](hid_t root) {
    const h5::Handle dataset = h5::open_dataset(root, layer);
    const h5::Handle y = h5::open_dataset(root, "y");
    const h5::Handle x = h5::open_dataset(root, "x");
    if (H5DSattach_scale(dataset.get(), y.get(), 0) < 0 || H5DSattach_scale(dataset.get(), x.get(), 1) < 0)
      throw IoError("attaching the coordinates failed: " + h5::failure_reason());
  });
}

h5::Handle GridLayerWriter::create(const std::string& name, h5::Type type, const LayerText& given) const {
  const LayerText text = completed(kind_, name, given);
  const BinIndex tile = tile_of(spec_);
  const bool is_real = type == h5::Type::float64 || type == h5::Type::float32;
  h5::Handle dataset =
      h5::create_dataset(root_, name, type,
                         {.size = {static_cast<hsize_t>(spec_.rows), static_cast<hsize_t>(spec_.cols)},
                          .chunk = {static_cast<hsize_t>(tile.row), static_cast<hsize_t>(tile.col)},
                          .level = compression_,
                          .nan_fill = is_real});
  attach_scales(name);
  if (is_real) write_fill_value(dataset.get(), type);
  h5::write_attribute(dataset.get(), "units", text.units);
  h5::write_attribute(dataset.get(), "long_name", text.long_name);
  if (frame_ != CfFrame::local) h5::write_attribute(dataset.get(), "grid_mapping", std::string("crs"));
  if (!text.ancillary_variables.empty())
    h5::write_attribute(dataset.get(), "ancillary_variables", text.ancillary_variables);
  if (!text.comment.empty()) h5::write_attribute(dataset.get(), "comment", text.comment);
  if (text.epoch_s) h5::write_attribute(dataset.get(), "epoch_s", *text.epoch_s);
  if (text.truth_spacing_m) h5::write_attribute(dataset.get(), kTruthSpacing, *text.truth_spacing_m);
  if (!text.flag_values.empty()) h5::write_attribute(dataset.get(), "flag_values", text.flag_values);
  if (!text.flag_masks.empty()) h5::write_attribute(dataset.get(), "flag_masks", text.flag_masks);
  if (!text.flag_meanings.empty()) h5::write_attribute(dataset.get(), "flag_meanings", text.flag_meanings);
  return dataset;
}

void GridLayerWriter::write_tile(hid_t dataset, const std::string& name, BinIndex first,
                                 std::span<const std::byte> bytes) const {
  const hsize_t offset[2] = {static_cast<hsize_t>(first.row), static_cast<hsize_t>(first.col)};
  const std::lock_guard lock(
      h5::library_lock());  // the written values may be computed from another file's layer
  if (!h5::write_chunk(dataset, offset, bytes))
    throw IoError("writing layer " + name + " failed: " + h5::failure_reason());
}

template <class T>
void GridLayerWriter::write(const std::string& name, const Grid<T>& layer, const LayerText& text) {
  const h5::Handle dataset = begin<T>(name, text);
  require_no_infinity(std::as_bytes(std::span(layer.values())), h5::TypeOf<T>::value, "layer " + name);
  write_tiles(dataset.get(), layer, {tile_of(spec_), {}}, compression_, name);
  ValueRange range;
  range.add(layer.values());
  write_range<T>(dataset, range);
}

template <class T>
h5::Handle GridLayerWriter::begin(const std::string& name, const LayerText& text) const {
  return create(name, h5::TypeOf<T>::value, text);
}

template <class T>
void GridLayerWriter::write_rows(const h5::Handle& layer, const std::string& name,
                                 const Grid<T>& rows) const {
  require_no_infinity(std::as_bytes(std::span(rows.values())), h5::TypeOf<T>::value, "layer " + name);
  write_tiles(layer.get(), rows, {tile_of(spec_), {rows.spec().first_row - spec_.first_row, 0}}, compression_,
              name);
}

template <class T>
void GridLayerWriter::write_range(const h5::Handle& layer, const ValueRange& range) {
  write_actual_range(layer.get(), h5::TypeOf<T>::value, range);
}

template h5::Handle GridLayerWriter::begin<double>(const std::string&, const LayerText&) const;
template h5::Handle GridLayerWriter::begin<float>(const std::string&, const LayerText&) const;
template void GridLayerWriter::write_rows(const h5::Handle&, const std::string&, const Grid<double>&) const;
template void GridLayerWriter::write_rows(const h5::Handle&, const std::string&, const Grid<float>&) const;
template void GridLayerWriter::write_range<double>(const h5::Handle&, const ValueRange&);
template void GridLayerWriter::write_range<float>(const h5::Handle&, const ValueRange&);
template void GridLayerWriter::write(const std::string&, const Grid<double>&, const LayerText&);
template void GridLayerWriter::write(const std::string&, const Grid<float>&, const LayerText&);
template void GridLayerWriter::write(const std::string&, const Grid<std::int32_t>&, const LayerText&);
template void GridLayerWriter::write(const std::string&, const Grid<std::int8_t>&, const LayerText&);

std::vector<GridLayerWriter::Tile> GridLayerWriter::tiles() const {
  const BinIndex size = tile_of(spec_);
  std::vector<Tile> result;
  for (std::int64_t row = 0; row < spec_.rows; row += size.row)
    for (std::int64_t col = 0; col < spec_.cols; col += size.col)
      result.push_back(
          {{row, col}, std::min(size.row, spec_.rows - row), std::min(size.col, spec_.cols - col), size.col});
  return result;
}

void GridLayerWriter::write_tiled(const std::vector<TiledLayer>& layers, const FillTile& fill,
                                  const ProgressCallback& progress) {
  std::vector<h5::Handle> datasets;
  datasets.reserve(layers.size());
  for (const TiledLayer& layer : layers) datasets.push_back(create(layer.name, layer.type, layer.text));
  struct Slot {
    std::vector<TileValues> values;
    std::vector<ChunkEncoder> encoders;  ///< one per layer, reused for all tiles
    std::vector<std::span<const std::byte>> encoded;
    std::vector<ValueRange> ranges;
  };
  std::vector<Slot> slots(thread_count() + 2);
  const std::vector<Tile> todo = tiles();
  const auto compute = [&](std::size_t i, std::size_t slot) {
    auto& [values, encoders, encoded, ranges] = slots[slot];
    values.resize(layers.size());
    encoded.resize(layers.size());
    ranges.resize(layers.size());
    if (encoders.empty())
      for (const TiledLayer& layer : layers) encoders.emplace_back(h5::size_of(layer.type), compression_);
    for (std::size_t l = 0; l < layers.size(); ++l)
      prepare(values[l], layers[l].type, static_cast<std::size_t>(tile_of(spec_).row * tile_of(spec_).col));
    fill(todo[i], values);
    for (std::size_t l = 0; l < layers.size(); ++l) {
      ranges[l] = range_of(todo[i], values[l]);
      const auto bytes = std::visit([](const auto& v) { return std::as_bytes(std::span(v)); }, values[l]);
      require_no_infinity(bytes, layers[l].type, "layer " + layers[l].name);
      encoded[l] = encoders[l].encode(bytes);
    }
  };
  std::vector<ValueRange> ranges(layers.size());
  const auto write_out = [&](std::size_t i, std::size_t slot) {
    for (std::size_t l = 0; l < layers.size(); ++l) {
      write_tile(datasets[l].get(), layers[l].name, todo[i].first, slots[slot].encoded[l]);
      ranges[l].add(slots[slot].ranges[l]);
    }
    report(progress, static_cast<double>(i + 1) / static_cast<double>(todo.size()));
  };
  produce_in_parallel(todo.size(), slots.size(), compute, write_out);
  for (std::size_t l = 0; l < layers.size(); ++l)
    write_actual_range(datasets[l].get(), layers[l].type, ranges[l]);
}

GridLayerReader::GridLayerReader(const LandfallFileReader& file)
    : file_(file), spec_(read_spec(file)), crs_wkt_(read_crs(file)) {}

bool GridLayerReader::has(const std::string& name) const { return h5::exists(file_.root(), name); }

h5::Handle GridLayerReader::open(const std::string& name) const {
  h5::Handle dataset = h5::open_dataset(file_.root(), name);
  if (!dataset) file_.fail("no layer /" + name);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  if (h5::extent_of(space.get()) !=
      std::vector{static_cast<hsize_t>(spec_.rows), static_cast<hsize_t>(spec_.cols)})
    file_.fail("layer /" + name + " is not of the shape (y, x) = (" + std::to_string(spec_.rows) + ", " +
               std::to_string(spec_.cols) + ")");
  return dataset;
}

template <class T>
Grid<T> GridLayerReader::read(const std::string& name, const ProgressCallback& progress) const {
  const h5::Handle dataset = open(name);
  auto layer = Grid<T>::unset(spec_);
  if (!read_tiles(dataset.get(), layer, {tile_of(spec_), {}}, progress) &&
      !h5::read_values(dataset.get(), h5::native(h5::TypeOf<T>::value), layer.values().data()))
    file_.fail("reading layer /" + name + " failed: " + h5::reading_failure());
  report(progress, 1);
  return layer;
}

template <class T>
void GridLayerReader::check(const Grid<T>& layer, const std::string& name, LayerValues allowed) const {
  try {
    require_values(layer, name, allowed, layer.spec().first_row - spec_.first_row);
  } catch (const FormatError& error) {
    file_.fail(error.what());
  }
}

template <class T>
Grid<T> GridLayerReader::read_checked(const std::string& name, LayerValues allowed) const {
  Grid<T> layer = read<T>(name);
  check(layer, name, allowed);
  return layer;
}

Grid<double> GridLayerReader::read_checked_rows(const std::string& name, LayerValues allowed,
                                                const GridSpec& rows) const {
  Grid<double> layer = read_window<double>(name, rows);
  check(layer, name, allowed);
  return layer;
}

BinIndex GridLayerReader::tile() const { return tile_of(spec_); }

template <class T>
Grid<T> GridLayerReader::read_window(const std::string& name, const GridSpec& window,
                                     const ProgressCallback& progress) const {
  const BinIndex first{window.first_row - spec_.first_row, window.first_col - spec_.first_col};
  auto part = Grid<T>::unset(window);
  const std::lock_guard lock(h5::library_lock());
  const h5::Handle dataset = open(name);
  bool done = false;
  // Otherwise a thread that waits for tiles of others might start work that needs this lock.
  run_isolated([&] { done = read_tiles(dataset.get(), part, {tile_of(spec_), first}, progress); });
  if (!done &&
      !read_rectangle(dataset.get(), h5::native(h5::TypeOf<T>::value), first, window, part.values().data()))
    file_.fail("reading layer /" + name + " failed: " + h5::reading_failure());
  report(progress, 1);
  return part;
}

Grid<double> GridLayerReader::read_part(const std::string& name, const GridSpec& part) const {
  const BinIndex before{(part.first_row - spec_.first_row) % tile().row,
                        (part.first_col - spec_.first_col) % tile().col};
  const GridSpec wider{part.resolution_m, part.first_row - before.row, part.first_col - before.col,
                       part.rows + before.row, part.cols + before.col};
  return cut_out(read_window<double>(name, wider), part);
}

std::optional<std::array<double, 2>> GridLayerReader::range(const std::string& name) const {
  return h5::read_pair_attribute(open(name).get(), "actual_range");
}

std::optional<double> GridLayerReader::truth_spacing_m() const {
  if (!has("z_true")) return std::nullopt;
  const std::optional<double> spacing_m = h5::read_number_attribute(open("z_true").get(), kTruthSpacing);
  return spacing_m && *spacing_m > 0 && std::isfinite(*spacing_m) ? spacing_m : std::nullopt;
}

template Grid<double> GridLayerReader::read_window(const std::string&, const GridSpec&,
                                                   const ProgressCallback&) const;
template Grid<float> GridLayerReader::read_window(const std::string&, const GridSpec&,
                                                  const ProgressCallback&) const;
template Grid<double> GridLayerReader::read_checked(const std::string&, LayerValues) const;
template Grid<float> GridLayerReader::read_checked(const std::string&, LayerValues) const;
template Grid<std::int32_t> GridLayerReader::read_checked(const std::string&, LayerValues) const;
template Grid<double> GridLayerReader::read(const std::string&, const ProgressCallback&) const;
template Grid<float> GridLayerReader::read(const std::string&, const ProgressCallback&) const;
template Grid<std::int32_t> GridLayerReader::read(const std::string&, const ProgressCallback&) const;
template Grid<std::int8_t> GridLayerReader::read(const std::string&, const ProgressCallback&) const;

}  // namespace landfall
