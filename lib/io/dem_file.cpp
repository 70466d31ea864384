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
};

template <class T>
LayerWriter simple(const std::string& name, Grid<T> (*make)(const BinAccumulator&), const char* units,
                   const char* long_name) {
  return {name, [=](GridLayerWriter& out, const BinAccumulator& bins, const DemRequest&) {
            out.write(name, make(bins), {units, long_name});
          }};
}

void write_z_true(GridLayerWriter& out, const BinAccumulator& bins, const DemRequest& request) {
  if (request.truth == nullptr) return;
  const auto elevation = [&](double x_m, double y_m) { return request.truth->elevation(x_m, y_m); };
  out.write("z_true", z_true_layer(bins, elevation, request.truth_at),
            {"m", request.truth_at == TruthAt::bin_center ? "true elevation under the bin centre's true place"
                                                          : "true elevation at the mean true position"});
}

const std::vector<LayerWriter>& layer_writers() {
  static const std::vector<LayerWriter> kWriters = {
      simple("z_est", z_est_layer, "m", "estimated elevation"),
      simple("count", count_layer, "1", "returns in the bin"),
      simple("weight_sum", weight_sum_layer, "1", "sum of the returns' weights"),
      simple("x_true", x_true_layer, "m", "mean true x of the bin's returns"),
      simple("y_true", y_true_layer, "m", "mean true y of the bin's returns"),
      {"z_true", write_z_true},
      simple("x_est_mean", x_est_mean_layer, "m", "mean estimated x of the bin's returns"),
      simple("y_est_mean", y_est_mean_layer, "m", "mean estimated y of the bin's returns"),
      simple("t_mean", t_mean_layer, "s", "mean time of the bin's returns"),
      simple("z_spread", z_spread_layer, "m", "weighted standard deviation of the estimated elevations")};
  return kWriters;
}

bool wanted(const DemRequest& request, const std::string& name) {
  return request.layers.empty() ||
         std::find(request.layers.begin(), request.layers.end(), name) != request.layers.end();
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
    const auto& known = dem_layer_names();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      std::string list;
      for (const std::string& layer : known) list += (list.empty() ? "" : ", ") + layer;
      throw UsageError("--layers: '" + name + "' is no layer; known: " + list);
    }
    if (name == "z_true" && request.truth == nullptr) throw UsageError("--layers: z_true needs --terrain");
  }
}

void write_dem(LandfallFileWriter& file, const BinAccumulator& bins, const DemRequest& request,
               const std::string& crs_wkt, const ProgressCallback& progress) {
  GridLayerWriter out(file, bins.spec(), crs_wkt);
  const auto& writers = layer_writers();
  for (std::size_t i = 0; i < writers.size(); ++i) {
    if (wanted(request, writers[i].name)) writers[i].write(out, bins, request);
    report(progress, static_cast<double>(i + 1) / static_cast<double>(writers.size()));
  }
  file.commit();
}

}  // namespace landfall
