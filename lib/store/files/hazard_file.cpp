// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/hazard_file.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/core/mapped.h"
#include "base/memory/available_memory.h"
#include "base/raster/grid_spec.h"
#include "formats/gdal/gdal_loader.h"
#include "store/files/contents.h"
#include "store/files/field_json.h"
#include "store/files/grid_file.h"
#include "store/files/map_position_json.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

const std::vector<std::int8_t> kSafetyValues = {0, 1, 2};
constexpr const char* kSafetyMeanings = "hazard safe unknown";

OrderedJson true_safe(Safety truth) {
  return truth == Safety::unknown ? OrderedJson(nullptr) : OrderedJson(truth == Safety::safe);
}

void write_measures(GridLayerWriter& layers, const PlaceMeasures& measures, const std::string& suffix) {
  const auto write = [&](const std::string& name, const Grid<double>& values) {
    layers.write(name + suffix, single_precision(values), {.ancillary_variables = "safe" + suffix});
  };
  write("slope", measures.slope_deg);
  write("roughness", measures.roughness_m);
}

float or_nan(const std::optional<float>& value) {
  return value.value_or(std::numeric_limits<float>::quiet_NaN());
}

TruthCentroids bin_centers(const GridSpec& spec) {
  TruthCentroids centers{Grid<double>(spec), Grid<double>(spec)};
  for (std::int64_t row = 0; row < spec.rows; ++row)
    for (std::int64_t col = 0; col < spec.cols; ++col) {
      centers.x.at({row, col}) = spec.x(col);
      centers.y.at({row, col}) = spec.y(row);
    }
  return centers;
}

}  // namespace

Grid<float> single_precision(const Grid<double>& values) {
  auto rounded = Grid<float>::unset(values.spec());
  std::ranges::transform(values.values(), rounded.values().begin(),
                         [](double value) { return static_cast<float>(value); });
  return rounded;
}

void require_gridded(const LandfallFileReader& file) {
  if (kind_of(file) == "terrain" && !has_grid(file))
    file.fail("is a mesh terrain; hazard-map judges a DEM or a gridded terrain");
}

HazardSource read_hazard_source(const std::filesystem::path& path, bool with_truth) {
  const LandfallFileReader file(path, {"dem", "terrain"});
  require_gridded(file);
  const std::string kind = kind_of(file);
  const GridLayerReader layers(file);
  constexpr std::uint64_t kBytesPerBin = 42;  // elevations, with a margin, and measures, at least
  const GridSpec& spec = layers.spec();
  require_memory(kBytesPerBin * spec.size(), file.name() + ": judging " + size_text(spec),
                 "--layers slope,roughness,safe judges it in strips");
  HazardSource source;
  source.kind = kind;
  source.z = layers.read_checked<double>(kind == "dem" ? "z_est" : "z", LayerValues::finite);
  source.crs_wkt = layers.crs_wkt();
  source.file_id = file.file_id();
  source.chain = file.chain();
  if (kind == "dem" && layers.has("z_sigma_rel"))
    source.z_sigma = layers.read_checked<double>("z_sigma_rel", LayerValues::not_negative);
  if (source.z_sigma && layers.has("z_sigma_noise"))
    source.noise_sigma = layers.read_checked<double>("z_sigma_noise", LayerValues::not_negative);
  if (source.z_sigma && layers.has("x_est_mean") && layers.has("y_est_mean"))
    source.centroids = {layers.read_checked<float>("x_est_mean", LayerValues::finite),
                        layers.read_checked<float>("y_est_mean", LayerValues::finite)};
  if (with_truth && kind == "dem" && layers.has("z_true"))
    source.z_true = layers.read_checked<double>("z_true", LayerValues::finite);
  if (source.z_true) source.truth_spacing_m = layers.truth_spacing_m();
  source.is_imported = is_imported(source.chain);
  return source;
}

TruthCentroids read_truth_centroids(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"dem"});
  const GridLayerReader layers(file);
  if (is_imported(file.chain()) && !layers.has("x_true")) return bin_centers(layers.spec());
  return {layers.read_checked<double>("x_true", LayerValues::finite),
          layers.read_checked<double>("y_true", LayerValues::finite)};
}

void write_sites(const LandfallFileWriter& file, const HazardMap& map) {
  const std::vector<LandingSite>& sites = map.sites;
  std::vector<std::int32_t> rank;
  while (rank.size() < sites.size()) rank.push_back(static_cast<std::int32_t>(rank.size() + 1));
  const auto x = mapped(sites, &LandingSite::x_m);
  const auto y = mapped(sites, &LandingSite::y_m);
  const auto z = mapped(sites, &LandingSite::z_m);
  const auto cost = mapped(sites, &LandingSite::cost);
  const auto p_touchdown = mapped(sites, &LandingSite::p_touchdown);
  const auto p_safe = mapped(sites, [](const LandingSite& s) { return or_nan(s.p_safe); });
  const auto p_capped =
      mapped(sites, [](const LandingSite& s) { return static_cast<std::int8_t>(s.p_capped ? 1 : 0); });
  const auto slope = mapped(sites, &LandingSite::slope_deg);
  const auto roughness = mapped(sites, &LandingSite::roughness_m);
  const auto distance = mapped(sites, [](const LandingSite& s) { return or_nan(s.hazard_distance_m); });
  const auto truth = mapped(sites, [](const LandingSite& s) { return static_cast<std::int8_t>(s.truth); });
  using enum h5::Type;
  std::vector<ColumnSpec> columns = {
      {"rank", int32, "1", "rank of the site, 1 is the best"},
      {"x", float64, "m", "x of the bin's centre"},
      {"y", float64, "m", "y of the bin's centre"},
      {"z", float64, "m", "elevation of the bin"},
      {"cost", float32, "1", "cost of landing here"},
      {"p_touchdown", float32, "1", "probability that a touchdown aimed here is safe"},
      {"slope", float64, "degree", "largest slope of a lander that stands here"},
      {"roughness", float64, "m", "largest height of the ground above the plane of the lander"},
      {"distance_to_hazard", float32, "m", "distance to the nearest place of the region that is not safe"}};
  std::vector<ColumnRows> rows = {std::span(std::as_const(rank)),
                                  std::span(x),
                                  std::span(y),
                                  std::span(z),
                                  std::span(cost),
                                  std::span(p_touchdown),
                                  std::span(slope),
                                  std::span(roughness),
                                  std::span(distance)};
  std::vector<std::vector<double>> on_map;
  for (const MapCoordinate& coordinate : kMapCoordinates) {
    if (sites.empty() || !(sites.front().map.*coordinate.value)) continue;
    columns.push_back({coordinate.column, float64, coordinate.units, coordinate.description});
    on_map.push_back(mapped(sites, [&](const LandingSite& s) {
      return (s.map.*coordinate.value).value_or(std::numeric_limits<double>::quiet_NaN());
    }));
  }
  for (const std::vector<double>& values : on_map) rows.emplace_back(std::span(values));
  if (map.p_safe) {
    columns.push_back({"p_safe", float32, "1", "probability that the place is safe"});
    rows.emplace_back(std::span(p_safe));
    columns.push_back(
        {"p_capped", int8, "1", "whether the evidence allows no larger p_safe: it is at least so large"});
    rows.emplace_back(std::span(p_capped));
  }
  if (map.truth) {
    columns.push_back({"true_safe", int8, "1", "whether the place is safe on the true ground", kSafetyValues,
                       kSafetyMeanings});
    rows.emplace_back(std::span(truth));
  }
  write_table(file.root(), "sites", std::move(columns), rows, file.compression());
}

void write_hazards(LandfallFileWriter& file, const HazardMap& map, const std::string& crs_wkt) {
  GridLayerWriter layers(file, map.safe.spec(), crs_wkt);
  write_measures(layers, map.measures, "");
  layers.write("safe", map.safe);
  if (map.p_safe) layers.write("p_safe", *map.p_safe, {.comment = map.p_safe_origin});
  layers.write("p_touchdown", map.p_touchdown);
  layers.write("cost", map.cost);
  layers.write("distance_to_hazard", map.hazard_distance);
  if (map.truth) {
    write_measures(layers, map.truth->measures, "_true");
    layers.write("safe_true", map.truth->safe);
    layers.write("outcome", map.truth->outcome);
    h5::write_text(file.root(), {"score_json", "the comparison with the true ground in numbers"},
                   score_json(map.truth->score).dump(2));
  }
  write_sites(file, map);
  file.commit();
}

void place_on_map(std::vector<LandingSite>& sites, const std::string& crs_wkt) {
  const auto points = mapped(sites, [](const LandingSite& site) { return SitePoint{site.x_m, site.y_m}; });
  const std::vector<MapPosition> positions = map_positions(crs_wkt, points);
  for (std::size_t i = 0; i < sites.size(); ++i) sites[i].map = positions[i];
}

OrderedJson site_json(const LandingSite& site) {
  OrderedJson json = {{"x_m", site.x_m}, {"y_m", site.y_m}};
  json.update(map_position_json(site.map));
  json.update(OrderedJson{{"z_m", site.z_m},
                          {"cost", site.cost},
                          {"p_touchdown", site.p_touchdown},
                          {"p_safe", or_null(site.p_safe)},
                          {"slope_deg", site.slope_deg},
                          {"roughness_m", site.roughness_m},
                          {"distance_to_hazard_m", or_null(site.hazard_distance_m)},
                          {"true_safe", true_safe(site.truth)},
                          {"p_capped", site.p_safe ? OrderedJson(site.p_capped) : OrderedJson()}});
  return json;
}

OrderedJson sites_json(const HazardMap& map) {
  OrderedJson sites = OrderedJson::array();
  for (const LandingSite& site : map.sites) {
    OrderedJson ranked = {{"rank", sites.size() + 1}};
    ranked.update(site_json(site));
    sites.push_back(std::move(ranked));
  }
  return {{"format", "landfall.sites"},
          {"version", 1},
          {"probability", map.p_safe.has_value()},
          {"sites", std::move(sites)}};
}

OrderedJson score_json(const HazardScore& score) {
  using Point = HazardScore::RocPoint;
  using Bin = HazardScore::ReliabilityBin;
  OrderedJson roc = {{"roughness_limit_m", mapped(score.roc, &Point::roughness_limit_m)},
                     {"missed_hazard_frac",
                      mapped(score.roc, [](const Point& p) { return or_null(p.rates.missed_hazard_frac); })},
                     {"false_alarm_frac",
                      mapped(score.roc, [](const Point& p) { return or_null(p.rates.false_alarm_frac); })}};
  OrderedJson reliability = {
      {"p_low", mapped(score.reliability, &Bin::p_low)},
      {"p_high", mapped(score.reliability, &Bin::p_high)},
      {"count", mapped(score.reliability, &Bin::count)},
      {"safe_frac", mapped(score.reliability, [](const Bin& bin) { return or_null(bin.safe_frac); })}};
  const OrderedJson numbers = fields_json(score);
  const bool has_own = !score.own_requirements.all.empty();
  OrderedJson json = {{"format", "landfall.hazard_score"}, {"version", 1}};
  if (has_own) json["pass"] = all_pass(score.own_requirements);
  for (const char* const key : {"counts", "filled_truth_bins", "missed_hazard_frac", "false_alarm_frac"})
    json[key] = numbers.at(key);
  json["roc"] = std::move(roc);
  json["brier"] = numbers.at("brier");
  json["reliability"] = std::move(reliability);
  if (has_own) json["own_requirements"] = fields_json(score.own_requirements);
  return json;
}

}  // namespace landfall
