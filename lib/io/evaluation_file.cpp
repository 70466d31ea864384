// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/evaluation_file.h"

#include <array>
#include <utility>
#include <vector>

#include "io/metrics_json.h"
#include "io/table.h"

namespace landfall {
namespace {

const char* name_of(Axis axis) { return axis == Axis::x ? "x" : axis == Axis::y ? "y" : "z"; }

void write_holes(const LandfallFileWriter& file, const GridSpec& spec, const std::vector<Hole>& holes) {
  std::vector<std::int32_t> id;
  std::vector<std::int64_t> size;
  std::vector<std::int64_t> row;
  std::vector<std::int64_t> col;
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> first_x;
  std::vector<double> first_y;
  std::vector<double> distance;
  for (const Hole& hole : holes) {
    id.push_back(hole.id);
    size.push_back(hole.size_bins);
    row.push_back(hole.first.row);
    col.push_back(hole.first.col);
    first_x.push_back(spec.x(hole.first.col));
    first_y.push_back(spec.y(hole.first.row));
    x.push_back(hole.centroid_x_m);
    y.push_back(hole.centroid_y_m);
    distance.push_back(hole.largest_distance_bins);
  }
  const std::array<ColumnRows, 9> rows = {
      std::span<const std::int32_t>(id),  std::span<const std::int64_t>(size),
      std::span<const std::int64_t>(row), std::span<const std::int64_t>(col),
      std::span<const double>(first_x),   std::span<const double>(first_y),
      std::span<const double>(x),         std::span<const double>(y),
      std::span<const double>(distance)};
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

}  // namespace

DemInput read_dem(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"dem"});
  const GridLayerReader layers(file);
  DemInput dem{{layers.read<double>("z_est"), std::nullopt}, layers.crs_wkt(), file.file_id(), file.chain()};
  if (layers.has("x_true") && layers.has("y_true") && layers.has("z_true"))
    dem.layers.truth = TrueLayers{layers.read<double>("x_true"), layers.read<double>("y_true"),
                                  layers.read<double>("z_true")};
  return dem;
}

EvaluationWriter::EvaluationWriter(LandfallFileWriter& file, const GridSpec& spec, std::string crs_wkt)
    : file_(file), spec_(spec), crs_wkt_(std::move(crs_wkt)) {}

GridLayerWriter& EvaluationWriter::grid() {
  if (!grid_) grid_.emplace(file_, spec_, crs_wkt_);
  return *grid_;
}

void EvaluationWriter::take(const CoverageLayers& layers) {
  grid().write("in_region", layers.in_region,
               {"1", "bin lies in the judged region", {0, 1}, "outside inside"});
  grid().write("invalid", layers.invalid,
               {"1", "bin of the region without an elevation", {0, 1}, "valid invalid"});
  grid().write("hole_id", layers.hole_id, {"1", "number of the 8-connected hole, 0 for none"});
  grid().write("distance_to_valid", layers.distance_to_valid,
               {"1", "distance to the nearest valid bin, in bins"});
}

void EvaluationWriter::take(Axis axis, const AxisLayers& layers) {
  const std::string name = name_of(axis);
  grid().write("e_" + name, layers.error, {"m", "true minus estimated " + name});
  grid().write("abs_" + name, layers.absolute, {"m", "mean of e_" + name + " over the footprint"});
  grid().write("rel_" + name, layers.relative,
               {"m", "quantile of the deviation of e_" + name + " from its mean over the footprint"});
}

void EvaluationWriter::take(const Grid<std::int8_t>& fail) {
  GridLayerWriter::LayerText text{"1", "missed requirements of the bin or of the footprint centred on it"};
  text.flag_masks = {kFailRelativeX,          kFailRelativeY, kFailRelativeZ,
                     kFailAbsoluteHorizontal, kFailHoleSize,  kFailDistance};
  text.flag_meanings = "relative_x relative_y relative_z absolute_horizontal hole_size hole_distance";
  grid().write("fail", fail, text);
}

void EvaluationWriter::finish(const Evaluation& evaluation) {
  write_holes(file_, spec_, evaluation.holes);
  h5::write_text(file_.root(), {"metrics_json", "metrics and verdicts"},
                 metrics_json(evaluation.metrics).dump(2));
  grid_.reset();
  file_.commit();
}

}  // namespace landfall
