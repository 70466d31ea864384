// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/mesh_terrain_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "store/files/crs.h"
#include "store/hdf5/chunk_codec.h"

namespace landfall {
namespace {

constexpr std::size_t kChunkRows = 65536;

struct RowsDataset {
  std::string name;
  h5::Type type;
  std::string units;
  std::string long_name;
};

/// Writes rows of three values, whose bytes are given, chunk by chunk; the last chunk is padded with 0.
void write_rows(const LandfallFileWriter& file, hid_t group, const RowsDataset& what,
                std::span<const std::byte> bytes) {
  const std::size_t row_size = 3 * h5::size_of(what.type);
  const std::size_t rows = bytes.size() / row_size;
  const std::size_t chunk_rows = std::min(rows, kChunkRows);
  const h5::Handle dataset =
      h5::create_dataset(group, what.name, what.type,
                         {.size = {rows, 3}, .chunk = {chunk_rows, 3}, .level = file.compression()});
  h5::write_attribute(dataset.get(), "units", what.units);
  h5::write_attribute(dataset.get(), "long_name", what.long_name);
  ChunkEncoder encoder(h5::size_of(what.type), file.compression());
  std::vector<std::byte> chunk(chunk_rows * row_size);
  for (std::size_t row = 0; row < rows; row += chunk_rows) {
    const auto part = bytes.subspan(row * row_size, std::min(chunk_rows, rows - row) * row_size);
    std::fill(std::copy(part.begin(), part.end(), chunk.begin()), chunk.end(), std::byte{0});
    const std::span<const std::byte> stored = encoder.encode(chunk);
    const hsize_t offset[2] = {row, 0};
    if (!h5::write_chunk(dataset.get(), offset, stored))
      throw IoError("writing /mesh/" + what.name + " failed: " + h5::failure_reason());
  }
}

/// Reads rows of three values.
template <class T>
std::vector<T> read_rows(const LandfallFileReader& file, hid_t group, const std::string& name) {
  const std::string path = "/mesh/" + name;
  const h5::Handle dataset = h5::open_dataset(group, name);
  if (!dataset) file.fail("no dataset " + path);
  const h5::Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const std::vector<hsize_t> size = h5::extent_of(space.get());
  if (size.size() != 2 || size[1] != 3) file.fail(path + " is not of the shape (rows, 3)");
  if (size[0] > kMaxMeshElements) file.fail(path + " has more than 2^31 - 1 rows");
  if (size[0] * 3 * sizeof(T) > h5::stored_bytes(dataset.get()) * kMaxDeflate)
    file.fail(path + " claims more rows than it can hold");
  std::vector<T> values(3 * size[0]);
  if (!h5::read_values(dataset.get(), h5::native(h5::TypeOf<T>::value), values.data()))
    file.fail("reading " + path + " failed: " + h5::reading_failure());
  return values;
}

}  // namespace

void write_mesh_terrain(LandfallFileWriter& file, const IndexedTriangles& mesh) {
  static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));
  write_crs(file.root(), "");
  const h5::Handle group = h5::create_group(file.root(), "mesh");
  write_rows(file, group.get(),
             {"vertices", h5::Type::float64, "m", "x, y, z of the vertex in the DEM frame"},
             std::as_bytes(std::span(mesh.vertices)));
  write_rows(file, group.get(),
             {"triangles", h5::Type::int32, "1", "rows of /mesh/vertices that are the triangle's corners"},
             std::as_bytes(std::span(mesh.triangles)));
  file.commit();
}

std::shared_ptr<const TriangleMesh> read_mesh_terrain(const LandfallFileReader& file) {
  const h5::Handle group = h5::open_group(file.root(), "mesh");
  if (!group) file.fail("/mesh is not a group");
  const auto coordinates = read_rows<double>(file, group.get(), "vertices");
  const auto corners = read_rows<std::int32_t>(file, group.get(), "triangles");
  IndexedTriangles mesh;
  mesh.vertices.reserve(coordinates.size() / 3);
  for (std::size_t i = 0; i < coordinates.size(); i += 3)
    mesh.vertices.emplace_back(coordinates[i], coordinates[i + 1], coordinates[i + 2]);
  mesh.triangles.resize(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] < 0) file.fail("/mesh/triangles holds the negative number " + std::to_string(corners[i]));
    mesh.triangles[i / 3][i % 3] = static_cast<std::uint32_t>(corners[i]);
  }
  return std::make_shared<const TriangleMesh>(std::move(mesh), file.name());
}

}  // namespace landfall
