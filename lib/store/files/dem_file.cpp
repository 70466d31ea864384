// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D381
#include "store/files/dem_file.h"

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/text/joined.h"
#include "store/files/grid_file.h"

namespace landfall {
namespace {

/// Part of a row of the map, and the offset of its values in a tile.
struct Strip {
  const GridSpec& spec;
  const GriddedScans& scans;
  const DemRequest& request;
  BinIndex first;
  std::span<const BinValues> bins;
  std::span<const BinSigmas> sigmas;  ///< empty unless a layer of them is written
  std::size_t offset;
};

/// The options that a layer needs and the request lacks; empty if it has all of them.
using Missing = std::string (*)(const DemRequest&);

std::string nothing_missing(const DemRequest& /*request*/) { return ""; }
std::string terrain_missing(const DemRequest& request) { return request.truth == nullptr ? "--terrain" : ""; }
std::string true_points_missing(const DemRequest& request) {
  return request.true_points ? "" : "scans with true points; an imported scan has none";
}
std::string times_missing(const DemRequest& request) { return request.times ? "" : "scans with times"; }
std::string uncertainty_missing(const DemRequest& request) {
  return request.uncertainty ? "" : "--uncertainty";
}
std::string map_truth_missing(const DemRequest& request) {
  return request.uncertainty ? terrain_missing(request) : "--uncertainty";
}
std::string correction_missing(const DemRequest& request) { return request.corrected ? "" : "--corrected"; }
std::string corrected_sigma_missing(const DemRequest& request) {
  return request.uncertainty ? correction_missing(request) : "--uncertainty";
}

struct Layer {
  std::string name;
  h5::Type type;
  LayerText text;
  std::function<void(const Strip&, GridLayerWriter::TileValues&)> put;
  Missing missing = nothing_missing;
  bool is_sigma = false;
};

BinIndex bin_of(const Strip& strip, std::size_t i) {
  return {strip.first.row, strip.first.col + static_cast<std::int64_t>(i)};
}

template <class T, class Value>
void put(const Strip& strip, GridLayerWriter::TileValues& tile, Value value) {
  T* const out = std::get<std::vector<T>>(tile).data() + strip.offset;
  for (std::size_t i = 0; i < strip.bins.size(); ++i) out[i] = static_cast<T>(value(i));
}

template <class T, class Member>
Layer simple(const std::string& name, Member BinValues::*member, Missing missing = nothing_missing) {
  const auto put_values = [=](const Strip& strip, GridLayerWriter::TileValues& tile) {
    put<T>(strip, tile, [&](std::size_t i) { return strip.bins[i].*member; });
  };
  return {name, h5::TypeOf<T>::value, {}, put_values, missing};
}

void put_z_true(const Strip& strip, GridLayerWriter::TileValues& tile) {
  const DemRequest& request = strip.request;
  const auto elevation = [&](double x_m, double y_m) { return request.truth->elevation(x_m, y_m); };
  put<double>(strip, tile, [&](std::size_t i) {
    return true_elevation(strip.bins[i], strip.spec, bin_of(strip, i), elevation, request.truth_at);
  });
}

/// The long name says at which point the true elevation is taken.
std::string truth_words(const DemRequest& request) {
  if (!request.true_points) return "true elevation at the bin centre";
  return request.truth_at == TruthAt::bin_center ? "true elevation under the bin centre's true position" : "";
}

Layer z_true(const DemRequest& request) {
  return {"z_true",
          h5::Type::float64,
          {.long_name = truth_words(request), .truth_spacing_m = request.truth_spacing_m},
          put_z_true,
          terrain_missing};
}

/// value(bin) for each bin that holds a return, NaN for the others.
template <class Value>
Layer of_filled_bins(const std::string& name, Missing missing, Value value) {
  const auto put_values = [=](const Strip& strip, GridLayerWriter::TileValues& tile) {
    put<float>(strip, tile, [&](std::size_t i) {
      return strip.bins[i].count > 0 ? static_cast<double>(value(strip, i))
                                     : std::numeric_limits<double>::quiet_NaN();
    });
  };
  return {name, h5::Type::float32, {}, put_values, missing};
}

double true_elevation_of_map(const Strip& strip, std::size_t i) {
  const BinIndex bin = bin_of(strip, i);
  return strip.request.truth->elevation(strip.spec.x(bin.col), strip.spec.y(bin.row));
}

double corrected(const Strip& strip, std::size_t i) {
  const BinIndex bin = bin_of(strip, i);
  return corrected_elevation(strip.bins[i], strip.spec, bin, strip.scans.slopes.at(bin));
}

Layer sigma(const std::string& name, double BinSigmas::*member, Missing missing) {
  const auto put_values = [=](const Strip& strip, GridLayerWriter::TileValues& tile) {
    put<float>(strip, tile, [&](std::size_t i) { return strip.sigmas[i].*member; });
  };
  return {name, h5::Type::float32, {}, put_values, missing, true};
}

std::vector<Layer> all_layers(const DemRequest& request) {
  return {simple<double>("z_est", &BinValues::z_est),
          simple<std::int32_t>("count", &BinValues::count),
          simple<double>("weight_sum", &BinValues::weight_sum),
          simple<double>("x_true", &BinValues::x_true, true_points_missing),
          simple<double>("y_true", &BinValues::y_true, true_points_missing),
          z_true(request),
          simple<float>("x_est_mean", &BinValues::x_est),
          simple<float>("y_est_mean", &BinValues::y_est),
          simple<double>("t_mean", &BinValues::t, times_missing),
          simple<float>("z_spread", &BinValues::spread),
          of_filled_bins("z_corrected", correction_missing, corrected),
          of_filled_bins("z_true_map", map_truth_missing, true_elevation_of_map),
          sigma("z_sigma_abs", &BinSigmas::z_abs, uncertainty_missing),
          sigma("z_sigma_rel", &BinSigmas::z_rel, uncertainty_missing),
          sigma("z_sigma_noise", &BinSigmas::z_noise, uncertainty_missing),
          sigma("z_corrected_sigma_abs", &BinSigmas::corrected_abs, corrected_sigma_missing),
          sigma("z_corrected_sigma_rel", &BinSigmas::corrected_rel, corrected_sigma_missing),
          sigma("xy_sigma", &BinSigmas::xy, uncertainty_missing)};
}

/// The layers that qualify a layer's values: how many returns, how they scatter, how uncertain the result is.
std::vector<std::string> qualifiers_of(const std::string& layer) {
  if (layer == "z_est") return {"count", "weight_sum", "z_spread", "z_sigma_abs", "z_sigma_rel"};
  if (layer == "z_corrected") return {"count", "z_corrected_sigma_abs", "z_corrected_sigma_rel"};
  return {};
}

/// The qualifiers that are in the file, in the form of CF's ancillary_variables.
std::string ancillary_variables(const std::string& layer, const std::vector<Layer>& written) {
  return joined(qualifiers_of(layer), " ", [&](const std::string& name) {
    return std::ranges::count(written, name, &Layer::name) > 0 ? name : "";
  });
}

bool wanted(const DemRequest& request, const Layer& layer) {
  if (request.layers.empty()) return layer.missing(request).empty();
  return std::ranges::count(request.layers, layer.name) > 0;
}

}  // namespace

const std::vector<std::string>& dem_layer_names() {
  static const std::vector<std::string> kNames = mapped(all_layers(DemRequest{}), &Layer::name);
  return kNames;
}

void check_layers(const DemRequest& request) {
  const std::vector<Layer> layers = all_layers(request);
  for (const std::string& name : request.layers) {
    const auto layer = std::ranges::find(layers, name, &Layer::name);
    if (layer == layers.end())
      throw UsageError("--layers: '" + name + "' is not a layer; known layers: " + joined(dem_layer_names()));
    const std::string option = layer->missing(request);
    if (!option.empty()) throw UsageError("--layers: " + name + " needs " + option);
  }
}

std::int64_t write_dem(LandfallFileWriter& file, const GriddedScans& scans, const DemRequest& request,
                       const std::string& crs_wkt, const ProgressCallback& progress) {
  const Accumulator& bins = *scans.bins;
  GridLayerWriter out(file, bins.spec(), crs_wkt);
  std::vector<Layer> layers = all_layers(request);
  std::erase_if(layers, [&](const Layer& layer) { return !wanted(request, layer); });
  std::vector<GridLayerWriter::TiledLayer> tiled;
  tiled.reserve(layers.size());
  for (const Layer& layer : layers) {
    tiled.push_back({layer.name, layer.type, layer.text});
    tiled.back().text.ancillary_variables = ancillary_variables(layer.name, layers);
    if (layer.is_sigma) tiled.back().text.comment = request.left_out;
    if (layer.missing == times_missing) tiled.back().text.epoch_s = request.epoch_s;
  }
  const bool has_sigmas = std::ranges::any_of(layers, &Layer::is_sigma);
  std::atomic<std::int64_t> empty_bins = 0;
  const auto fill = [&](const GridLayerWriter::Tile& tile, std::span<GridLayerWriter::TileValues> values) {
    std::vector<BinValues> row(static_cast<std::size_t>(tile.cols));
    std::vector<BinSigmas> sigmas(has_sigmas ? row.size() : 0);
    for (std::int64_t r = 0; r < tile.rows; ++r) {
      const BinIndex first{tile.first.row + r, tile.first.col};
      bins.values(first, row);
      empty_bins += std::ranges::count_if(row, [](const BinValues& bin) { return bin.count == 0; });
      for (std::size_t i = 0; i < sigmas.size(); ++i)
        sigmas[i] = scans.uncertainty->sigmas({first.row, first.col + static_cast<std::int64_t>(i)});
      const Strip strip{
          bins.spec(), scans, request, first, row, sigmas, static_cast<std::size_t>(r * tile.stride)};
      for (std::size_t l = 0; l < layers.size(); ++l) layers[l].put(strip, values[l]);
    }
  };
  out.write_tiled(tiled, fill, progress);
  file.commit();
  return empty_bins;
}

}  // namespace landfall
