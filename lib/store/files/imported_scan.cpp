// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D407
#include "store/files/imported_scan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "store/files/column_specs.h"
#include "store/files/crs.h"

namespace landfall {
namespace {

constexpr const char* kFirstTime = "first_t_s";
constexpr const char* kImportedTime = name_of(&PulseColumns::t);

/// Calls use(column) for each column of /points that an import has, in their order in all scans.
template <class Use>
void for_each_imported(const ImportedColumns& wanted, const Use& use) {
  for_each_column(kPointColumns, [&](const auto& column) {
    const std::string name = column.name;
    const bool is_written = name == "x_est" || name == "y_est" || name == "z_est" || name == "status" ||
                            std::ranges::count(wanted.of_points, name) > 0;
    if (is_written) use(column);
  });
}

std::vector<ColumnSpec> specs_of_import(const ImportedColumns& columns) {
  std::vector<ColumnSpec> specs;
  for_each_imported(columns, [&](const auto& column) {
    specs.push_back(spec_of(column, false));
    if (specs.back().name == "intensity") specs.back().long_name = "intensity, in the unit of the source";
    if (specs.back().name == "pulse") specs.back().long_name = "number of the pulse in the source";
    if (specs.back().name == "pixel") specs.back().long_name = "number of the pixel in the source";
    if (specs.back().name == "status") specs.back().long_name = "a return, or marked as noise in the source";
  });
  if (columns.t)
    specs.push_back({kImportedTime, h5::Type::float64, "s",
                     "time of the return" + (columns.clock.empty() ? "" : ": " + columns.clock)});
  return specs;
}

}  // namespace

ImportedScanWriter::ImportedScanWriter(LandfallFileWriter& file, ImportedColumns columns,
                                       const std::string& crs_wkt)
    : file_(file),
      columns_(std::move(columns)),
      points_(file.root(), "points", specs_of_import(columns_), file.compression()) {
  write_crs(file.root(), crs_wkt);
}

void ImportedScanWriter::append(const ImportedPoints& points) {
  std::vector<ColumnRows> rows;
  for_each_imported(columns_,
                    [&](const auto& column) { rows.push_back(rows_of_column(column, points.columns)); });
  if (columns_.t) rows.emplace_back(std::span(points.t));
  points_.append(rows);
  false_returns_ += std::ranges::count(points.columns.status, PointStatus::false_return);
}

void ImportedScanWriter::commit(const ImportedOrigin& origin) {
  points_.finish();
  const hid_t group = points_.group();
  const auto count = static_cast<std::int64_t>(points_.row_count());
  h5::write_attribute(group, "return_count", count - false_returns_);
  h5::write_attribute(group, "false_return_count", false_returns_);
  h5::write_attribute(group, "misses_kept", std::int64_t{0});
  h5::write_attribute(group, "imported_from", origin.format);
  h5::write_attribute(group, "origin_x", origin.center[0]);
  h5::write_attribute(group, "origin_y", origin.center[1]);
  h5::write_attribute(group, "origin_z", origin.center[2]);
  if (columns_.t) h5::write_attribute(group, kFirstTime, origin.first_t_s);
  name_rows(file_.root(), "points", "point");
  file_.commit();
}

bool is_imported_scan(const LandfallFileReader& scan) {
  return !h5::exists(scan.root(), "pulses") &&
         !TableReader(scan.root(), "points", scan.name()).has(name_of(&PointColumns::x_true));
}

double imported_epoch_s(const LandfallFileReader& scan) {
  const TableReader points(scan.root(), "points", scan.name());
  const double first_s = h5::read_number_attribute(points.group(), kFirstTime).value_or(0);
  return std::isfinite(first_s) ? first_s : 0;
}

SourceHeights source_heights(const LandfallFileReader& scan) {
  const TableReader points(scan.root(), "points", scan.name());
  const nlohmann::json& config = scan.config();
  const bool has_scale =
      config.is_object() && config.contains("vertical_scale") && config["vertical_scale"].is_number();
  const double center = h5::read_number_attribute(points.group(), "origin_z").value_or(0);
  const double scale = has_scale ? config["vertical_scale"].get<double>() : 1;
  return {std::isfinite(center) ? center : 0, std::isfinite(scale) && scale != 0 ? scale : 1};
}

}  // namespace landfall
