// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/bin_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/returns/point_status.h"
#include "base/text/number_text.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/contents.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/files/map_position_json.h"
#include "store/files/scan_file.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// A return of the bin, as its row of the scan.
struct BinReturn {
  std::size_t row = 0;
  double x_est_m = 0;
  double y_est_m = 0;
  std::int8_t status = 0;
};

std::vector<BinReturn> returns_in(const TableReader& points, const Placement& placement, const GridSpec& grid,
                                  BinIndex bin, const ProgressCallback& progress) {
  const std::size_t rows = points.row_count("status");
  std::vector<BinReturn> found;
  std::array<std::vector<double>, 2> xy;
  std::vector<std::int8_t> status;
  for (std::size_t begin = 0; begin < rows; begin += kTableChunkRows) {
    const std::size_t count = std::min(kTableChunkRows, rows - begin);
    status.resize(count);
    for (std::vector<double>& values : xy) values.resize(count);
    points.read<double>("x_est", begin, xy[0]);
    points.read<double>("y_est", begin, xy[1]);
    points.read<std::int8_t>("status", begin, status);
    placement.to_first(xy[0], xy[1]);
    for (std::size_t i = 0; i < count; ++i) {
      if (!is_return(static_cast<PointStatus>(status[i]))) continue;
      if (grid.bin_of(xy[0][i], xy[1][i]) == bin) found.push_back({begin + i, xy[0][i], xy[1][i], status[i]});
    }
    report(progress, static_cast<double>(begin + count) / static_cast<double>(rows));
  }
  return found;
}

OrderedJson value_at(const TableReader& points, const char* column, std::size_t row,
                     const Placement& placement = {}) {
  if (!points.has(column)) return nullptr;
  std::array<double, 1> value = {0};
  points.read<double>(column, row, value);
  placement.raise(value);
  return std::isfinite(value[0]) ? OrderedJson(value[0]) : OrderedJson(nullptr);
}

/// Null where the scan, an imported one, has no such column.
OrderedJson integer_at(const TableReader& points, const char* column, std::size_t row) {
  if (!points.has(column)) return nullptr;
  std::array<std::int32_t, 1> value = {0};
  points.read<std::int32_t>(column, row, value);
  return value[0];
}

/// The time of a return since the scan's epoch.
OrderedJson time_at(const ScanReader& scan, const TableReader& points, const OrderedJson& pulse,
                    std::size_t row) {
  if (!scan.has_truth()) {
    const OrderedJson t = value_at(points, "t", row);
    return t.is_number() ? OrderedJson(t.get<double>() - scan.epoch_s()) : OrderedJson(nullptr);
  }
  const auto number = pulse.get<std::int64_t>();
  if (number < 0 || static_cast<std::size_t>(number) >= scan.pulse_times_s().size()) return nullptr;
  return scan.pulse_times_s()[static_cast<std::size_t>(number)];
}

/// The weight of a return by the method of a DEM; none where the method has no weights.
std::optional<double> weight_of(const std::string& method, const GridSpec& grid, BinIndex bin,
                                const BinReturn& point) {
  if (method == "mean") return 1;
  if (method != "bilinear_nearest") return std::nullopt;
  const double p = std::abs(point.x_est_m - grid.x(bin.col)) / grid.resolution_m;
  const double q = std::abs(point.y_est_m - grid.y(bin.row)) / grid.resolution_m;
  return (1 - p) * (1 - q);
}

const char* status_name(std::int8_t status) {
  return kPointStatuses.at(static_cast<std::size_t>(status)).meaning;
}

std::string method_of(const LandfallFileReader& dem) {
  return dem.config().is_object() ? dem.config().value("method", "") : "";
}

/// `weight_sum` is that of the DEM, in which other scans may have returns too.
OrderedJson returns_json(const LandfallFileReader& dem, const GridLayerReader& layers, BinIndex bin,
                         const OrderedJson& weight_sum, const std::filesystem::path& path,
                         const ProgressCallback& progress) {
  const ScanReader scan(path);
  const GridSpec& grid = layers.spec();
  const Placement placement = placement_in_dem(dem, layers.crs_wkt(), dem.file_id(), scan);
  const TableReader points(scan.file().root(), "points", scan.file().name());
  const std::vector<BinReturn> found = returns_in(points, placement, grid, bin, progress);
  const std::string method = method_of(dem);
  double sum = 0;
  for (const BinReturn& point : found) sum += weight_of(method, grid, bin, point).value_or(0);
  if (weight_sum.is_number()) sum = weight_sum.get<double>();
  OrderedJson all = OrderedJson::array();
  for (const BinReturn& point : found) {
    const OrderedJson pulse = integer_at(points, "pulse", point.row);
    const std::optional<double> weight = weight_of(method, grid, bin, point);
    OrderedJson entry = {{"pulse", pulse},
                         {"pixel", integer_at(points, "pixel", point.row)},
                         {"t_s", time_at(scan, points, pulse, point.row)},
                         {"status", status_name(point.status)},
                         {"range_true_m", value_at(points, "range_true", point.row)},
                         {"range_measured_m", value_at(points, "range_measured", point.row)},
                         {"x_est_m", point.x_est_m},
                         {"y_est_m", point.y_est_m},
                         {"z_est_m", value_at(points, "z_est", point.row, placement)},
                         {"weight", weight ? OrderedJson(*weight) : OrderedJson(nullptr)},
                         {"share", weight && sum > 0 ? OrderedJson(*weight / sum) : OrderedJson(nullptr)}};
    all.push_back(std::move(entry));
  }
  return all;
}

/// One value of each layer, by its name.
OrderedJson layers_json(const LandfallFileReader& dem, const GridLayerReader& grid, BinIndex bin) {
  const GridSpec one = part_of(grid.spec(), bin, 1, 1);
  OrderedJson layers = OrderedJson::object();
  for (const ContentInfo& layer : layers_of(dem, grid.spec())) {
    const double value = grid.read_part(layer.name, one).values().front();
    const bool is_whole = layer.type != h5::Type::float64 && layer.type != h5::Type::float32;
    layers[layer.name] = !std::isfinite(value) ? OrderedJson(nullptr)
                         : is_whole            ? OrderedJson(static_cast<std::int64_t>(value))
                                               : OrderedJson(value);
  }
  return layers;
}

OrderedJson units_json(const LandfallFileReader& dem, const GridSpec& spec) {
  OrderedJson units = OrderedJson::object();
  for (const ContentInfo& layer : layers_of(dem, spec)) units[layer.name] = layer.units;
  return units;
}

}  // namespace

std::vector<std::string> inputs_of(const LandfallFileReader& made, const std::string& step,
                                   const std::string& role) {
  std::vector<std::string> ids;
  for (const nlohmann::json& each : made.chain())
    if (each.value("file_id", "") == step)
      for (const nlohmann::json& input : each.value("inputs", nlohmann::json::array()))
        if (input.value("role", "") == role) ids.push_back(input.value("file_id", ""));
  return ids;
}

Placement placement_in_dem(const LandfallFileReader& made, const std::string& crs_wkt, const std::string& dem,
                           const ScanReader& scan) {
  require_input(made, inputs_of(made, dem, "scan"), scan.file());
  MeetingRules rules;
  for (const nlohmann::json& step : made.chain()) {
    if (step.value("file_id", "") != dem || !step.contains("options")) continue;
    rules = {step["options"].value("same_frame", false), step["options"].contains("vertical_datum")};
  }
  const Sited own{scan.file().name(), scan.crs_wkt()};
  return meet(meeting_kind("scans"), {made.name(), crs_wkt}, own, rules).placement;
}

void require_input(const LandfallFileReader& made, const std::vector<std::string>& inputs,
                   const LandfallFileReader& source) {
  if (std::ranges::find(inputs, source.file_id()) == inputs.end())
    source.fail("is not a " + kind_of(source) + " that " + made.name() +
                " was made from (its file_id is not among the inputs)");
}

BinIndex bin_on_map(const GridSpec& spec, const SitePoint& point, const std::string& name) {
  const BinIndex bin = spec.bin_of(point.x_m, point.y_m);
  if (spec.contains(bin)) return bin;
  throw UsageError("--at " + number_text(point.x_m) + "," + number_text(point.y_m) + " is off the map of " +
                   name + ": x from " + number_text(spec.x(0)) + " to " + number_text(spec.x(spec.cols - 1)) +
                   " m, y from " + number_text(spec.y(0)) + " to " + number_text(spec.y(spec.rows - 1)) +
                   " m");
}

OrderedJson place_of_bin(const std::filesystem::path& path, const GridLayerReader& grid, BinIndex bin) {
  const GridSpec& spec = grid.spec();
  const SitePoint centre{spec.x(bin.col), spec.y(bin.row)};
  OrderedJson json = {{"file", path.string()}, {"x_m", centre.x_m}, {"y_m", centre.y_m}};
  json.update(map_position_json(map_positions(grid.crs_wkt(), {centre}).front()));
  json.update(OrderedJson{{"row", bin.row}, {"column", bin.col}, {"resolution_m", spec.resolution_m}});
  return json;
}

OrderedJson describe_bin(const std::filesystem::path& path, const SitePoint& point,
                         const std::optional<std::filesystem::path>& scan, const ProgressCallback& progress) {
  const LandfallFileReader dem(path, {"dem"});
  const GridLayerReader grid(dem);
  const GridSpec& spec = grid.spec();
  const BinIndex bin = bin_on_map(spec, point, dem.name());
  OrderedJson json = place_of_bin(path, grid, bin);
  json.update(OrderedJson{{"layers", layers_json(dem, grid, bin)}, {"units", units_json(dem, spec)}});
  if (!scan) return json;
  const OrderedJson weight_sum = json["layers"].value("weight_sum", OrderedJson());
  json["returns"] = returns_json(dem, grid, bin, weight_sum, *scan, progress);
  return json;
}

}  // namespace landfall
