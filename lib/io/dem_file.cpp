// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/dem_file.h"

#include <algorithm>
#include <functional>

#include "base/error.h"
#include "io/grid_file.h"

namespace landfall {
namespace {

struct LayerWriter {
  std::string name;
  std::function<void(GridLayerWriter&, const BinAccumulator&, const DemRequest&)> write;
  /// Which options it needs; empty where the request has them.
  std::function<std::string(const DemRequest&)> missing = [](const DemRequest&) { return ""; };
};

template <class T>
LayerWriter simple(const std::string& name, Grid<T> (*make)(const BinAccumulator&), const char* units,
                   const char* long_name) {
  return {name, [=](GridLayerWriter& out, const BinAccumulator& bins, const DemRequest&) {
            out.write(name, make(bins), {units, long_name});
          }};
}

void write_z_true(GridLayerWriter& out, const BinAccumulator& bins, const DemRequest& request) {
  const auto elevation = [&](double x_m, double y_m) { return request.truth->elevation(x_m, y_m); };
  out.write("z_true", z_true_layer(bins, elevation, request.truth_at),
            {"m", request.truth_at == TruthAt::bin_center ? "true elevation under the bin centre's true place"
                                                          : "true elevation at the mean true position"});
}

void write_z_true_map(GridLayerWriter& out, const BinAccumulator& bins, const DemRequest& request) {
  const auto elevation = [&](double x_m, double y_m) { return request.truth->elevation(x_m, y_m); };
  out.write("z_true_map", z_true_map_layer(bins, elevation), {"m", "true elevation under the bin centre"});
}

void write_z_corrected(GridLayerWriter& out, const BinAccumulator& bins, const DemRequest& request) {
  out.write("z_corrected", z_corrected_layer(bins, *request.slopes),
            {"m", "estimated elevation, carried along the slope to the bin centre"});
}

LayerWriter sigma(const std::string& name, Grid<float> (UncertaintyMap::*make)() const, const char* of,
                  bool corrected = false) {
  return {name,
          [=](GridLayerWriter& out, const BinAccumulator&, const DemRequest& request) {
            out.write(name, (request.uncertainty_map->*make)(), {"m", std::string("one sigma of ") + of});
          },
          [=](const DemRequest& request) -> std::string {
            if (!request.uncertainty) return "--uncertainty";
            return corrected && !request.corrected ? "--corrected" : "";
          }};
}

std::string terrain_missing(const DemRequest& request) { return request.truth == nullptr ? "--terrain" : ""; }

std::string map_truth_missing(const DemRequest& request) {
  return request.uncertainty ? terrain_missing(request) : "--uncertainty";
}

std::string correction_missing(const DemRequest& request) { return request.corrected ? "" : "--corrected"; }

const std::vector<LayerWriter>& layer_writers() {
  static const std::vector<LayerWriter> kWriters = {
      simple("z_est", z_est_layer, "m", "estimated elevation"),
      simple("count", count_layer, "1", "returns in the bin"),
      simple("weight_sum", weight_sum_layer, "1", "sum of the returns' weights"),
      simple("x_true", x_true_layer, "m", "mean true x of the bin's returns"),
      simple("y_true", y_true_layer, "m", "mean true y of the bin's returns"),
      {"z_true", write_z_true, terrain_missing},
      simple("x_est_mean", x_est_mean_layer, "m", "mean estimated x of the bin's returns"),
      simple("y_est_mean", y_est_mean_layer, "m", "mean estimated y of the bin's returns"),
      simple("t_mean", t_mean_layer, "s", "mean time of the bin's returns"),
      simple("z_spread", z_spread_layer, "m", "weighted standard deviation of the estimated elevations"),
      {"z_corrected", write_z_corrected, correction_missing},
      {"z_true_map", write_z_true_map, map_truth_missing},
      sigma("z_sigma_abs", &UncertaintyMap::z_sigma_abs_layer, "z_true_map - z_est"),
      sigma("z_sigma_rel", &UncertaintyMap::z_sigma_rel_layer,
            "z_true_map - z_est without navigation errors"),
      sigma("z_corrected_sigma_abs", &UncertaintyMap::z_corrected_sigma_abs_layer, "z_true_map - z_corrected",
            true),
      sigma("z_corrected_sigma_rel", &UncertaintyMap::z_corrected_sigma_rel_layer,
            "z_true_map - z_corrected without navigation errors", true),
      sigma("xy_sigma", &UncertaintyMap::xy_sigma_layer, "the horizontal error along one axis")};
  return kWriters;
}

bool wanted(const DemRequest& request, const LayerWriter& layer) {
  if (request.layers.empty()) return layer.missing(request).empty();
  return std::find(request.layers.begin(), request.layers.end(), layer.name) != request.layers.end();
}

}  // namespace

const std::vector<std::string>& dem_layer_names() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const LayerWriter& writer : layer_writers()) names.push_back(writer.name);
    return names;
  }();
  return kNames;
}

void check_layers(const DemRequest& request) {
  for (const std::string& name : request.layers) {
    const auto& writers = layer_writers();
    const auto layer =
        std::find_if(writers.begin(), writers.end(), [&](const LayerWriter& w) { return w.name == name; });
    if (layer == writers.end()) {
      std::string list;
      for (const std::string& known : dem_layer_names()) list += (list.empty() ? "" : ", ") + known;
      throw UsageError("--layers: '" + name + "' is no layer; known: " + list);
    }
    const std::string option = layer->missing(request);
    if (!option.empty()) throw UsageError("--layers: " + name + " needs " + option);
  }
}

void write_dem(LandfallFileWriter& file, const BinAccumulator& bins, const DemRequest& request,
               const std::string& crs_wkt, const ProgressCallback& progress) {
  GridLayerWriter out(file, bins.spec(), crs_wkt);
  const auto& writers = layer_writers();
  for (std::size_t i = 0; i < writers.size(); ++i) {
    if (wanted(request, writers[i])) writers[i].write(out, bins, request);
    report(progress, static_cast<double>(i + 1) / static_cast<double>(writers.size()));
  }
  file.commit();
}

}  // namespace landfall
