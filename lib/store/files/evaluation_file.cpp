// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/evaluation_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/dictionary/layers.h"
#include "base/text/joined.h"
#include "store/files/crs.h"
#include "store/files/metrics_json.h"
#include "store/hdf5/infinite_values.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

const char* name_of(Axis axis) { return axis == Axis::x ? "x" : axis == Axis::y ? "y" : "z"; }

void write_holes(const LandfallFileWriter& file, const GridSpec& spec, const std::vector<Hole>& holes) {
  const auto id = mapped(holes, &Hole::id);
  const auto size = mapped(holes, &Hole::size_bins);
  const auto row = mapped(holes, [](const Hole& hole) { return hole.first.row; });
  const auto col = mapped(holes, [](const Hole& hole) { return hole.first.col; });
  const auto first_x = mapped(holes, [&](const Hole& hole) { return spec.x(hole.first.col); });
  const auto first_y = mapped(holes, [&](const Hole& hole) { return spec.y(hole.first.row); });
  const auto x = mapped(holes, &Hole::centroid_x_m);
  const auto y = mapped(holes, &Hole::centroid_y_m);
  auto distance = mapped(holes, &Hole::depth_bins);
  std::ranges::replace_if(distance, is_infinite<double>, std::numeric_limits<double>::quiet_NaN());
  const std::array<ColumnRows, 9> rows = {std::span(id),  std::span(size),    std::span(row),
                                          std::span(col), std::span(first_x), std::span(first_y),
                                          std::span(x),   std::span(y),       std::span(distance)};
  write_table(file.root(), "holes",
              {{"id", h5::Type::int32, "1", "number of the hole, by first bin in row-major order"},
               {"size_bins", h5::Type::int64, "1", "bins of the hole"},
               {"row", h5::Type::int64, "1", "row of the first bin"},
               {"column", h5::Type::int64, "1", "column of the first bin"},
               {"first_x", h5::Type::float64, "m", "x of the first bin's centre"},
               {"first_y", h5::Type::float64, "m", "y of the first bin's centre"},
               {"x", h5::Type::float64, "m", "x of the centroid"},
               {"y", h5::Type::float64, "m", "y of the centroid"},
               {"max_distance_bins", h5::Type::float64, "1", "largest distance to a valid bin, in bins"}},
              rows, file.compression());
}

/// The shape (y, x) of a layer of a mask.
std::array<std::int64_t, 2> shape_of(const h5::Handle& dataset, const std::string& where) {
  const std::vector<hsize_t> size = h5::extent_of(h5::Handle(H5Dget_space(dataset.get()), H5Sclose).get());
  if (size.size() != 2) throw FormatError(where + " does not have the shape (y, x)");
  return {static_cast<std::int64_t>(size[0]), static_cast<std::int64_t>(size[1])};
}

/// Throws FormatError unless the file's coordinates of this name, if it has any, are those expected.
void check_axis(hid_t file, const std::string& path, const std::string& name,
                const std::vector<double>& expected, double resolution_m, bool is_moved) {
  if (!h5::exists(file, name)) return;
  const h5::Handle dataset = h5::open_dataset(file, name);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  std::vector<double> found(expected.size());
  const bool same_size = H5Sget_simple_extent_npoints(space.get()) == static_cast<hssize_t>(expected.size());
  const auto near = [&](double a, double b) { return std::abs(a - b) <= 1e-6 * resolution_m; };
  if (same_size && !h5::read_values(dataset.get(), H5T_NATIVE_DOUBLE, found.data()))
    h5::fail_reading(file, name);
  if (!same_size || !std::ranges::equal(found, expected, near))
    throw FormatError(path + ": /" + name + " differs from the DEM's" +
                      (is_moved ? " by no whole number of bins" : ""));
}

/// Throws FormatError unless the coordinates of a mask, less its shift, are those of the grid.
void check_axes(hid_t file, const std::string& path, const GridSpec& spec,
                const std::array<double, 3>& shift_m) {
  std::vector<double> x(static_cast<std::size_t>(spec.cols));
  std::vector<double> y(static_cast<std::size_t>(spec.rows));
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = spec.x(static_cast<std::int64_t>(i)) - shift_m[0];
  for (std::size_t i = 0; i < y.size(); ++i) y[i] = spec.y(static_cast<std::int64_t>(i)) - shift_m[1];
  check_axis(file, path, "x", x, spec.resolution_m, shift_m[0] != 0);
  check_axis(file, path, "y", y, spec.resolution_m, shift_m[1] != 0);
}

/// The first bin of a mask along an axis, in the map's bins.
std::int64_t first_bin(hid_t file, const std::string& where, std::int64_t count, double shift_bins,
                       double resolution_m) {
  const std::string name = where.substr(where.rfind('/') + 1);
  const h5::Handle axis = h5::open_dataset(file, name);
  if (!axis) throw FormatError(where + " is missing, and the mask has another centre than the DEM");
  const h5::Handle space(H5Dget_space(axis.get()), H5Sclose);
  std::vector<double> values(static_cast<std::size_t>(count));
  if (H5Sget_simple_extent_npoints(space.get()) != count ||
      !h5::read_values(axis.get(), H5T_NATIVE_DOUBLE, values.data()))
    h5::fail_reading(file, name);
  const double first = values.empty() ? 0 : values.front() / resolution_m + shift_bins;
  if (!(std::abs(first) < 1e9)) throw FormatError(where + " lies beyond the DEM");
  return std::llround(first);
}

/// The grid of a mask in the map's bins: the map's own, or that of a mask that is moved.
GridSpec mask_grid(hid_t file, const std::string& path, const MaskedMap& map, const Placement& placement,
                   const std::array<std::int64_t, 2>& shape, const std::string& layer) {
  const std::array<double, 3>& shift_m = placement.shift_m();
  GridSpec mask = map.grid;
  if (!placement.is_identity()) {
    const double s = mask.resolution_m;
    std::tie(mask.rows, mask.cols) = std::pair(shape[0], shape[1]);
    mask.first_col = first_bin(file, path + ": /x", mask.cols, shift_m[0] / s, s);
    mask.first_row = first_bin(file, path + ": /y", mask.rows, shift_m[1] / s, s);
  }
  check_axes(file, path, mask, shift_m);
  if (shape != std::array{mask.rows, mask.cols})
    throw FormatError(path + ": layer /" + layer + " is not of the DEM's shape (" +
                      std::to_string(mask.rows) + ", " + std::to_string(mask.cols) + ")");
  return mask;
}

/// The frame of a mask, which may be the file of any tool; none if it gives none.
std::optional<std::string> frame_of_mask(const std::filesystem::path& path, hid_t file) {
  if (!h5::exists(file, "crs")) return std::nullopt;
  if (is_landfall_file(path)) return read_crs(LandfallFileReader(path, kLandfallKinds));
  return h5::read_text_attribute(h5::open_dataset(file, "crs").get(), "crs_wkt");
}

}  // namespace

RegionMask read_region_mask(const std::filesystem::path& path, const std::string& layer,
                            const MaskedMap& map) {
  h5::initialise();
  const h5::Handle file = h5::open_file(path);
  const std::string name = path.string();
  const h5::Handle dataset = h5::open_dataset(file.get(), layer);
  if (!dataset) throw FormatError(name + ": no layer /" + layer);
  Meeting meeting;
  if (const auto frame = frame_of_mask(path, file.get()))
    meeting = meet(meeting_kind("mask"), {map.name, map.crs_wkt}, {name, *frame}, map.rules);
  const GridSpec grid = mask_grid(file.get(), name, map, meeting.placement,
                                  shape_of(dataset, name + ": layer /" + layer), layer);
  Grid<double> values(grid);
  if (!h5::read_values(dataset.get(), H5T_NATIVE_DOUBLE, values.values().data()))
    throw FormatError(name + ": reading layer /" + layer + " failed: " + h5::reading_failure());
  RegionMask result{BinMask(map.grid), h5::read_text_attribute(file.get(), "file_id").value_or(""),
                    std::move(meeting.said)};
  if (result.file_id.empty()) result.file_id = content_id(path);
  for (std::int64_t row = 0; row < map.grid.rows; ++row)
    for (std::int64_t col = 0; col < map.grid.cols; ++col) {
      const BinIndex at{map.grid.first_row + row - grid.first_row, map.grid.first_col + col - grid.first_col};
      const double value = grid.contains(at) ? values.at(at) : 0;
      result.mask.at({row, col}) = value != 0 && !std::isnan(value) ? 1 : 0;
    }
  return result;
}

std::optional<UncertaintyLayers> read_uncertainty(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"dem"});
  const GridLayerReader layers(file);
  for (const char* const name : {"z_true_map", "z_sigma_abs", "z_sigma_rel"})
    if (!layers.has(name)) return std::nullopt;
  UncertaintyLayers result{error_of(Axis::z, layers.read_checked<double>("z_true_map", LayerValues::finite),
                                    layers.read<double>("z_est")),
                           layers.read_checked<float>("z_sigma_abs", LayerValues::not_negative),
                           layers.read_checked<float>("z_sigma_rel", LayerValues::not_negative),
                           std::nullopt};
  if (layers.has("count"))
    result.count = layers.read_checked<std::int32_t>("count", LayerValues::not_negative);
  return result;
}

std::optional<double> stored_limit(const LandfallFileReader& evaluation, const std::string& layer) {
  const dictionary::Layer* const words = dictionary::find_layer("evaluation", layer);
  const nlohmann::json& config = evaluation.config();
  if (words == nullptr || *words->limit == '\0' || !config.is_object()) return std::nullopt;
  const nlohmann::json limits = config.value("limits", nlohmann::json());
  if (!limits.is_object() || !limits.contains(words->limit) || !limits[words->limit].is_number())
    return std::nullopt;
  const auto limit = limits[words->limit].get<double>();
  return std::isfinite(limit) && limit >= 0 ? std::optional(limit) : std::nullopt;
}

DemInput read_dem(const std::filesystem::path& path, const ProgressCallback& progress) {
  constexpr double kMostLayers = 6;
  const LandfallFileReader file(path, {"dem"});
  const GridLayerReader layers(file);
  int done = 0;
  const auto read = [&](const char* name) {
    Grid<double> layer = layers.read<double>(name);
    report(progress, ++done / kMostLayers);
    return layer;
  };
  DemInput dem{
      {.z_est = read("z_est"), .truth = std::nullopt}, layers.crs_wkt(), file.file_id(), file.chain()};
  dem.has_sigmas = layers.has("z_sigma_abs");
  if (layers.has("count") && maker_of(dem.chain) != "landfall-import")
    dem.layers.count = layers.read_checked<std::int32_t>("count", LayerValues::not_negative);
  if (!layers.has("z_true")) return dem;
  dem.layers.truth_spacing_m = layers.truth_spacing_m();
  dem.layers.truth = TrueLayers{.x = {}, .y = {}, .z = read("z_true")};
  if (layers.has("x_true") && layers.has("y_true")) {
    dem.layers.truth->x = read("x_true");
    dem.layers.truth->y = read("y_true");
  }
  if (layers.has("z_corrected")) dem.layers.corrected = read("z_corrected");
  return dem;
}

DemWindowReader::DemWindowReader(const std::filesystem::path& path) : file_(path, {"dem"}), layers_(file_) {}

DemLayers DemWindowReader::read(const GridSpec& window) const {
  DemLayers result{.z_est = layers_.read_part("z_est", window), .truth = std::nullopt};
  if (!layers_.has("z_true")) return result;
  result.truth = TrueLayers{.x = {}, .y = {}, .z = layers_.read_part("z_true", window)};
  if (layers_.has("x_true") && layers_.has("y_true")) {
    result.truth->x = layers_.read_part("x_true", window);
    result.truth->y = layers_.read_part("y_true", window);
  }
  return result;
}

std::optional<Grid<std::int32_t>> DemWindowReader::count() const {
  if (!layers_.has("count")) return std::nullopt;
  return layers_.read_checked<std::int32_t>("count", LayerValues::not_negative);
}

EvaluationWriter::EvaluationWriter(const OutputOptions& options, const Provenance& provenance,
                                   const GridSpec& spec, std::string crs_wkt)
    : file_(options, "evaluation", provenance), spec_(spec), crs_wkt_(std::move(crs_wkt)) {}

GridLayerWriter& EvaluationWriter::grid() {
  if (!grid_) grid_.emplace(file_, spec_, crs_wkt_);
  return *grid_;
}

void EvaluationWriter::take(const CoverageLayers& layers) {
  grid().write("in_region", layers.in_region);
  grid().write("invalid", layers.invalid);
  grid().write("hole_id", layers.hole_numbers);
  if (std::ranges::none_of(layers.distance_to_valid.values(), is_infinite<float>)) {
    grid().write("distance_to_valid", layers.distance_to_valid);
    return;
  }
  Grid<float> none = layers.distance_to_valid;  // the DEM has no valid bin
  std::ranges::fill(none.values(), std::numeric_limits<float>::quiet_NaN());
  grid().write("distance_to_valid", none);
}

void EvaluationWriter::take(Axis axis, const AxisLayers& layers) {
  const std::string name = name_of(axis);
  const LayerText judged{.ancillary_variables = "fail"};  // always follows, as the last layer
  grid().write("e_" + name, layers.error);
  grid().write("abs_" + name, layers.absolute, judged);
  grid().write("rel_" + name, layers.relative, judged);
}

void EvaluationWriter::take(const Grid<std::int8_t>& fail) {
  const auto flags = fail_flags_by_bit();
  LayerText text{.flag_meanings = joined(flags, " ", &dictionary::FailFlag::name)};
  for (const dictionary::FailFlag& flag : flags)
    text.flag_masks.push_back(static_cast<std::int8_t>(flag.bit));
  grid().write("fail", fail, text);
}

void EvaluationWriter::finish(const Evaluation& evaluation, const EvaluationLimits& limits) {
  write_holes(file_, spec_, evaluation.holes);
  h5::write_text(file_.root(), {"metrics_json", "metrics and verdicts"},
                 metrics_json(evaluation.metrics).dump(2));
  h5::write_text(file_.root(), {"verdict_json", "the requirements as dem-eval prints them"},
                 verdict_json(evaluation.metrics, limits).dump(2));
  grid_.reset();
  file_.commit();
}

}  // namespace landfall
