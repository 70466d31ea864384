// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/file_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "base/numerics/non_finite.h"
#include "base/returns/columns.h"
#include "base/text/netcdf_name.h"
#include "base/text/number_text.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/crs.h"
#include "store/files/field_json.h"
#include "store/files/grid_file.h"
#include "store/files/imported_scan.h"
#include "store/files/landfall_file.h"
#include "store/files/map_position_json.h"
#include "store/files/place_json.h"
#include "store/files/stored_json.h"
#include "store/hdf5/dataset_list.h"
#include "store/hdf5/table.h"
#include "store/hdf5/value_statistics.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// The root's own datasets come first, under this name.
constexpr const char* kLayers = "layers";

OrderedJson parsed(const std::optional<std::string>& text) { return stored_json<OrderedJson>(text); }

std::string text_attribute(hid_t object, const char* name) {
  return h5::read_text_attribute(object, name).value_or("");
}

OrderedJson head(const std::filesystem::path& path, const LandfallFileReader& file) {
  const std::string format = text_attribute(file.root(), "format_name");
  OrderedJson json = {{"file", path.string()},
                      {"kind", format.substr(format.find('.') + 1)},
                      {"title", text_attribute(file.root(), "title")},
                      {"format_version", text_attribute(file.root(), "format_version")},
                      {"complete", true},
                      {"size_bytes", std::filesystem::file_size(path)},
                      {"file_id", file.file_id()},
                      {"source", text_attribute(file.root(), "source")}};
  const std::string wkt = read_crs(file);
  json["crs"] = {{"name", name_in_wkt(wkt).value_or("")}, {"wkt", wkt}, {"place", place_json(wkt)}};
  const OrderedJson origin = map_position_json(map_positions(wkt, {SitePoint{}}).front());
  if (!origin.empty()) json["crs"]["origin"] = origin;
  return json;
}

/// The names by which GDAL and GMT open the most important layer of a grid.
OrderedJson opens_as(const std::filesystem::path& path, const std::vector<DatasetEntry>& layers) {
  std::string layer = layers.front().name;
  for (const char* const elevation : {"z_est", "z", "e_z"})
    for (const DatasetEntry& entry : layers)
      if (entry.name == elevation) layer = elevation;
  const std::optional<std::string> gdal = netcdf_name(path.string(), layer);
  return {{"gdal", gdal ? OrderedJson(*gdal) : OrderedJson()}, {"gmt", path.string() + "?" + layer}};
}

OrderedJson grid_json(const GridSpec& spec) {
  return {{"resolution_m", spec.resolution_m},
          {"rows", spec.rows},
          {"columns", spec.cols},
          {"x_m", {spec.x(0), spec.x(spec.cols - 1)}},
          {"y_m", {spec.y(0), spec.y(spec.rows - 1)}}};
}

/// Counts how often each named value, or each named bit, occurs.
OrderedJson flag_counts(const DatasetEntry& entry, const ValueStatistics& statistics) {
  const bool bits = !entry.flag_masks.empty();
  const std::vector<int>& flags = bits ? entry.flag_masks : entry.flag_values;
  OrderedJson counts = OrderedJson::object();
  for (std::size_t i = 0; i < std::min(flags.size(), entry.flag_meanings.size()); ++i) {
    std::int64_t count = 0;
    for (std::size_t k = 0; k < statistics.int8_counts.size(); ++k) {
      const int value = static_cast<int>(k) - 128;
      if (bits ? (value & flags[i]) != 0 : value == flags[i]) count += statistics.int8_counts[k];
    }
    counts[entry.flag_meanings[i]] = count;
  }
  return counts;
}

void add_statistics(OrderedJson& json, const DatasetEntry& entry,
                    const std::optional<ValueStatistics>& statistics) {
  if (!statistics) {
    for (const char* const key : {"count", "nan_count", "infinite_count", "min", "max", "mean", "std"})
      json[key] = nullptr;
    json["not_read"] = "its chunks have more than " + grouped(kMaxChunkValues) +
                       " values; store it in smaller ones (h5repack)";
    return;
  }
  const ValueStatistics& s = *statistics;
  const bool any = s.count > 0;
  json["count"] = s.count;
  json["nan_count"] = s.nan_count;
  json["infinite_count"] = s.infinite_count;
  json["min"] = any ? finite_json(s.min) : OrderedJson(nullptr);
  json["max"] = any ? finite_json(s.max) : OrderedJson(nullptr);
  json["mean"] = any ? finite_json(s.mean) : OrderedJson(nullptr);
  json["std"] = any ? finite_json(s.std()) : OrderedJson(nullptr);
  if (entry.type == "int8" && !entry.flag_meanings.empty()) json["flag_counts"] = flag_counts(entry, s);
}

OrderedJson entry_json(const DatasetEntry& entry) {
  return {{"name", entry.name},   {"type", entry.type},
          {"shape", entry.shape}, {"stored_bytes", entry.stored_bytes},
          {"unit", entry.units},  {"long_name", entry.long_name}};
}

/// The datasets of a group, and the destination of the group's description.
struct Group {
  std::string name;
  std::vector<DatasetEntry> entries;
};

std::vector<Group> groups_of(const LandfallFileReader& file) {
  std::vector<Group> groups;
  std::vector<DatasetEntry> layers = list_datasets(file.root());
  std::erase_if(layers, [](const DatasetEntry& e) {  // H5DSis_scale() frees a damaged class twice
    return h5::read_text_attribute(e.dataset.get(), "CLASS") == "DIMENSION_SCALE";
  });
  if (!layers.empty()) groups.push_back({kLayers, std::move(layers)});
  for (const std::string& name : list_groups(file.root())) {
    if (name == "provenance") continue;
    const h5::Handle group = h5::open_group(file.root(), name);
    groups.push_back({name, list_datasets(group.get())});
  }
  return groups;
}

/// Converts the progress of one dataset to that of all, weighted by their numbers of values.
class Share {
 public:
  Share(const std::vector<Group>& groups, const ProgressCallback& progress) : progress_(progress) {
    for (const Group& group : groups)
      for (const DatasetEntry& entry : group.entries) all_ += entry.value_count();
  }
  [[nodiscard]] ProgressCallback of(const DatasetEntry& entry) {
    const double done = done_;
    done_ += entry.value_count();
    return [this, done, mine = entry.value_count()](double fraction) {
      if (all_ > 0) report(progress_, std::min(1.0, (done + fraction * mine) / all_));
    };
  }

 private:
  const ProgressCallback& progress_;
  double all_ = 0;
  double done_ = 0;
};

OrderedJson datasets_json(const LandfallFileReader& file, const std::vector<Group>& groups, bool statistics,
                          const ProgressCallback& progress) {
  Share share(groups, progress);
  OrderedJson result = OrderedJson::object();
  for (const Group& group : groups) {
    OrderedJson& list = result[group.name] = OrderedJson::array();
    for (const DatasetEntry& entry : group.entries) {
      list.push_back(entry_json(entry));
      if (!statistics) continue;
      const std::string name = (group.name == kLayers ? "/" : "/" + group.name + "/") + entry.name;
      add_statistics(list.back(), entry,
                     dataset_statistics(entry.dataset.get(), file.name(), name, share.of(entry)));
    }
  }
  return result;
}

/// The number of rows of a table, from its first column.
std::int64_t row_count(const OrderedJson& datasets, const char* group) {
  return datasets.contains(group) && !datasets[group].empty()
             ? datasets[group][0]["shape"][0].get<std::int64_t>()
             : 0;
}

OrderedJson config_member(const OrderedJson& config, std::initializer_list<const char*> path) {
  const OrderedJson* value = &config;
  for (const char* const key : path) {
    if (!value->is_object() || !value->contains(key)) return nullptr;
    value = &(*value)[key];
  }
  return *value;
}

OrderedJson scan_json(const LandfallFileReader& file, const OrderedJson& datasets,
                      const OrderedJson& config) {
  if (!h5::exists(file.root(), "pulses") && !is_imported_scan(file)) file.fail("no table /pulses");
  const std::int64_t pulses = row_count(datasets, "pulses");
  OrderedJson json = {{"row_count", row_count(datasets, "points")},
                      {"pulse_count", pulses},
                      {"pixel_count", row_count(datasets, "detector")},
                      {"detector_rows", config_member(config, {"detector", "rows"})},
                      {"detector_columns", config_member(config, {"detector", "columns"})},
                      {"t_first_s", nullptr},
                      {"t_last_s", nullptr}};
  std::array<double, 1> t = {};
  if (pulses > 0) {
    const TableReader table(file.root(), "pulses", file.name());
    table.read("t", 0, std::span<double>(t));
    json["t_first_s"] = finite_json(t[0]);
    table.read("t", static_cast<std::size_t>(pulses - 1), std::span<double>(t));
    json["t_last_s"] = finite_json(t[0]);
  }
  const TableReader points(file.root(), "points", file.name());
  if (is_imported_scan(file)) {
    json["imported_from"] = h5::read_text_attribute(points.group(), "imported_from").value_or("");
    for (const char* const axis : {"origin_x", "origin_y", "origin_z"})
      json[axis] = finite_json(h5::read_number_attribute(points.group(), axis).value_or(std::nan("")));
  }
  for (const PointStatusInfo& info : kPointStatuses) {
    if (!info.is_counted(points.has(name_of(&PointColumns::intensity)))) continue;
    const auto count = h5::read_number_attribute(points.group(), info.count_name);
    json[info.count_name] = count && std::abs(*count) < 0x1p62
                                ? OrderedJson(static_cast<std::int64_t>(*count))
                                : OrderedJson(nullptr);
  }
  json["misses_kept"] = h5::read_number_attribute(points.group(), "misses_kept").value_or(0) == 1;
  return json;
}

/// The least and greatest coordinate along each axis; `vertices` is of the shape (V, 3).
std::array<std::array<double, 2>, 3> mesh_bounds(const LandfallFileReader& file,
                                                 const DatasetEntry& vertices) {
  constexpr hsize_t kRows = 65536;
  std::array<std::array<double, 2>, 3> bounds;
  bounds.fill({kInfinity, -kInfinity});
  std::vector<double> values;
  for (hsize_t row = 0; row < vertices.shape[0]; row += kRows) {
    const std::array<hsize_t, 2> start = {row, 0};
    const std::array<hsize_t, 2> count = {std::min(kRows, vertices.shape[0] - row), 3};
    values.resize(3 * count[0]);
    if (!h5::read_block(vertices.dataset.get(), H5T_NATIVE_DOUBLE, start, count, values.data()))
      file.fail("reading /mesh/vertices failed: " + h5::reading_failure());
    for (std::size_t i = 0; i < values.size(); ++i) {
      bounds[i % 3][0] = std::min(bounds[i % 3][0], values[i]);
      bounds[i % 3][1] = std::max(bounds[i % 3][1], values[i]);
    }
  }
  return bounds;
}

OrderedJson mesh_json(const LandfallFileReader& file, const Group& mesh, bool statistics) {
  const auto find = [&](const char* name) -> const DatasetEntry& {
    for (const DatasetEntry& entry : mesh.entries)
      if (entry.name == name && entry.shape.size() == 2 && entry.shape[1] == 3) return entry;
    file.fail("no dataset /mesh/" + std::string(name) + " of the shape (n, 3)");
  };
  const DatasetEntry& vertices = find("vertices");
  OrderedJson json = {{"vertex_count", vertices.shape[0]}, {"triangle_count", find("triangles").shape[0]}};
  constexpr std::array kAxes = {"x_m", "y_m", "z_m"};
  for (const char* const axis : kAxes) json[axis] = nullptr;
  if (!statistics || vertices.shape[0] == 0) return json;
  const auto bounds = mesh_bounds(file, vertices);
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis)
    json[kAxes[axis]] = {finite_json(bounds[axis][0]), finite_json(bounds[axis][1])};
  return json;
}

OrderedJson features_json(const OrderedJson& datasets) {
  OrderedJson json = {{"count", row_count(datasets, "features")}, {"count_by_kind", nullptr}};
  for (const OrderedJson& entry : datasets["features"])
    if (entry["name"] == "kind" && entry.contains("flag_counts")) {
      json["count_by_kind"] = OrderedJson::object();
      for (const auto& [kind, count] : entry["flag_counts"].items())
        if (count != 0) json["count_by_kind"][kind] = count;
    }
  return json;
}

/// The first value of a column of /sites; none without a site.
std::optional<double> first_value(const LandfallFileReader& file, const DatasetEntry& column) {
  if (column.shape.size() != 1 || column.shape[0] == 0) return std::nullopt;
  const std::array<hsize_t, 1> first = {0}, one = {1};
  double value = 0;
  if (!h5::read_block(column.dataset.get(), H5T_NATIVE_DOUBLE, first, one, &value))
    file.fail("reading /sites/" + column.name + " failed: " + h5::reading_failure());
  return value;
}

/// Whether the first site is safe on the true terrain, null if there is no site or it is unknown; its
/// coordinates on the map, if the file has them.
OrderedJson best_site_json(const LandfallFileReader& file, const Group& sites) {
  OrderedJson json = {{"true_safe", nullptr}};
  for (const DatasetEntry& entry : sites.entries) {
    const auto* const coordinate = std::ranges::find(kMapCoordinates, entry.name, &MapCoordinate::column);
    if (entry.name != "true_safe" && coordinate == kMapCoordinates.end()) continue;
    const std::optional<double> value = first_value(file, entry);
    if (!value) continue;
    if (coordinate != kMapCoordinates.end())
      json[coordinate->key] = finite_json(*value);
    else if (*value == 0 || *value == 1)
      json["true_safe"] = *value == 1;
  }
  return json;
}

void add_provenance(OrderedJson& json, const LandfallFileReader& file) {
  json["config"] = file.config();
  json["options"] = nullptr;
  json["inputs"] = nullptr;
  json["environment"] = nullptr;
  if (!file.chain().empty() && file.chain().back().value("file_id", "") == file.file_id()) {
    const OrderedJson step = file.chain().back();
    json["tool"] = step["tool"];
    json["version"] = step["version"];
    json["inputs"] = step["inputs"];
    if (step.contains("options")) json["options"] = step["options"];
  }
  json["chain"] = file.chain();
  const h5::Handle group = h5::open_group(file.root(), "provenance");
  if (group) json["environment"] = parsed(h5::read_text(group.get(), "environment_json"));
}

}  // namespace

OrderedJson describe_file(const std::filesystem::path& path, const DescriptionOptions& options,
                          const ProgressCallback& progress) {
  const LandfallFileReader file(path, kLandfallKinds);
  OrderedJson json = head(path, file);
  if (h5::exists(file.root(), "x") && h5::exists(file.root(), "y"))
    json["grid"] = grid_json(GridLayerReader(file).spec());
  const std::vector<Group> groups = groups_of(file);
  if (json.contains("grid") && !groups.empty() && groups.front().name == kLayers)
    json["opens_as"] = opens_as(path, groups.front().entries);
  const OrderedJson datasets = datasets_json(file, groups, options.statistics, progress);
  report(progress, 1);
  if (json["kind"] == "scan") json["scan"] = scan_json(file, datasets, OrderedJson(file.config()));
  for (const Group& group : groups)
    if (json["kind"] == "hazards" && group.name == "sites") json["best_site"] = best_site_json(file, group);
  for (const Group& group : groups)
    if (group.name == "mesh") json["mesh"] = mesh_json(file, group, options.statistics);
  if (datasets.contains("features")) json["features"] = features_json(datasets);
  for (const std::string part : {"metrics", "plan", "score", "verdict"})
    if (h5::exists(file.root(), part + "_json"))
      json[part] = parsed(h5::read_text(file.root(), part + "_json"));
  json["datasets"] = datasets;
  add_provenance(json, file);
  return json;
}

}  // namespace landfall
