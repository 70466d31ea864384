// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/point_positions.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "base/core/error.h"
#include "store/files/provenance.h"
#include "store/hdf5/h5.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

void require(bool ok, const std::string& dataset) {
  if (!ok) throw IoError("writing " + dataset + " failed: " + h5::failure_reason());
}

void describe(hid_t dataset, const char* units, const char* long_name) {
  h5::write_attribute(dataset, "units", std::string(units));
  h5::write_attribute(dataset, "long_name", std::string(long_name));
}

/// In the name of a source, HDF5 replaces %b by the number of a block, and %% by a percent sign.
std::string source_name(const std::string& file) {
  std::string name;
  for (const char c : file) name += c == '%' ? "%%" : std::string(1, c);
  return name;
}

/// Maps each column of the virtual dataset to a column of the scan.
void map_columns(hid_t properties, hid_t space, const PointPositions& positions) {
  const hsize_t rows = positions.rows;
  const std::string scan = source_name(positions.scan);
  const h5::Handle source(H5Screate_simple(1, &rows, nullptr), H5Sclose);
  for (hsize_t axis = 0; axis < positions.columns.size(); ++axis) {
    const std::array<hsize_t, 2> start = {0, axis};
    const std::array<hsize_t, 2> count = {rows, 1};
    const std::string dataset = "/points/" + positions.columns[axis];
    require(H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
                H5Pset_virtual(properties, space, scan.c_str(), dataset.c_str(), source.get()) >= 0,
            "/position");
  }
}

void write_position(hid_t root, const PointPositions& positions) {
  const std::array<hsize_t, 2> size = {positions.rows, positions.columns.size()};
  const h5::Handle space(H5Screate_simple(2, size.data(), nullptr), H5Sclose);
  const h5::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  // If the scan is not found, positions are NaN rather than zero.
  const double nan = std::numeric_limits<double>::quiet_NaN();
  H5Pset_fill_value(properties.get(), H5T_NATIVE_DOUBLE, &nan);
  map_columns(properties.get(), space.get(), positions);
  H5Sselect_all(space.get());
  const h5::Handle dataset(H5Dcreate2(root, "position", h5::native(positions.type), space.get(), H5P_DEFAULT,
                                      properties.get(), H5P_DEFAULT),
                           H5Dclose);
  require(static_cast<bool>(dataset), "/position");
  describe(dataset.get(), "m", "x, y and z of the points in the DEM frame, as the scan has them");
}

/// Writes begin, begin + 1, ... to the rows [begin, begin + values.size()).
void write_rows(hid_t dataset, std::size_t begin, std::vector<std::int64_t>& values) {
  std::iota(values.begin(), values.end(), static_cast<std::int64_t>(begin));
  const std::array<hsize_t, 2> start = {begin, 0};
  const std::array<hsize_t, 2> count = {values.size(), 1};
  const h5::Handle space(H5Dget_space(dataset), H5Sclose);
  const h5::Handle memory(H5Screate_simple(2, count.data(), nullptr), H5Sclose);
  require(
      H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) >= 0 &&
          H5Dwrite(dataset, H5T_NATIVE_INT64, memory.get(), space.get(), H5P_DEFAULT, values.data()) >= 0,
      "/row");
}

void write_row(hid_t root, std::size_t rows, int compression) {
  const h5::Handle dataset = h5::create_dataset(
      root, "row", row_type(rows),
      {.size = {rows, 1}, .chunk = {std::min(kTableChunkRows, rows), 1}, .level = compression});
  describe(dataset.get(), "1", "row of the point");
  std::vector<std::int64_t> values;
  for (std::size_t begin = 0; begin < rows; begin += kTableChunkRows) {
    values.resize(std::min(kTableChunkRows, rows - begin));
    write_rows(dataset.get(), begin, values);
  }
}

void write_file(const std::filesystem::path& path, const PointPositions& positions, const std::string& tool,
                int compression) {
  h5::Handle file = h5::create_file(path);
  h5::write_attribute(file.get(), "title", std::string("Positions of a scan's points, for XDMF"));
  h5::write_attribute(file.get(), "source", source_line(tool));
  h5::write_attribute(file.get(), "scan_file_id", positions.scan_id);
  write_position(file.get(), positions);
  write_row(file.get(), positions.rows, compression);
  if (const std::optional<std::string> failure = h5::close_file(file))
    throw IoError("closing failed: " + *failure);
}

}  // namespace

h5::Type row_type(std::size_t rows) {
  return rows <= std::size_t{std::numeric_limits<std::int32_t>::max()} ? h5::Type::int32 : h5::Type::int64;
}

void write_point_positions(OutputPath& output, const PointPositions& positions, const std::string& tool,
                           int compression) {
  try {
    write_file(output.temporary(), positions, tool, compression);
  } catch (const IoError& error) {
    throw IoError("output " + output.path().string() + ": " + error.what());
  }
  output.flush();
}

}  // namespace landfall
