// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "base/error.h"
#include "base/file_extension.h"
#include "meshio/mesh_file.h"
#include "output/output_path.h"
#include "terrain/mesh/triangle_mesh.h"
#include "terrain/relief/triangulated_grid.h"

namespace landfall {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers go to PLY as they are in memory");

constexpr std::int64_t kRowsPerReport = 64;
constexpr std::size_t kElementsPerReport = 1U << 16U;

struct MeshSize {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

/// What receives a mesh: its vertices in order, then its triangles.
class MeshSink {
 public:
  explicit MeshSink(const std::filesystem::path& path) : stream_(path, std::ios::binary | std::ios::trunc) {}
  virtual ~MeshSink() = default;
  MeshSink(const MeshSink&) = delete;
  MeshSink& operator=(const MeshSink&) = delete;

  virtual void begin(const MeshSize& size) = 0;
  virtual void vertex(const Eigen::Vector3d& point) = 0;
  virtual void triangle(const TriangleCorners& corners) = 0;

  /// False where the disk refused.
  bool close() {
    flush();
    stream_.close();
    return static_cast<bool>(stream_);
  }

 protected:
  void add(std::string_view bytes) {
    buffer_.append(bytes);
    if (buffer_.size() > kBuffer) flush();
  }
  template <class T>
  void add_number(T value) {
    std::array<char, 32> text{};
    const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value);
    add({text.data(), static_cast<std::size_t>(end - text.data())});
  }
  template <class T>
  void add_bytes(const T& value) {
    std::array<char, sizeof(T)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof value);
    add({bytes.data(), bytes.size()});
  }

 private:
  static constexpr std::size_t kBuffer = 1U << 20U;
  void flush() {
    stream_.write(buffer_.data(), static_cast<std::streamsize>(buffer_.size()));
    buffer_.clear();
  }

  std::ofstream stream_;
  std::string buffer_;
};

class ObjSink final : public MeshSink {
 public:
  using MeshSink::MeshSink;
  void begin(const MeshSize&) override {
    add("# a landfall terrain: metres, x right, y up on the map, z up\n");
  }
  void vertex(const Eigen::Vector3d& point) override {
    add("v");
    for (const double coordinate : point) {
      add(" ");
      add_number(coordinate);
    }
    add("\n");
  }
  void triangle(const TriangleCorners& corners) override {
    add("f");
    for (const std::uint32_t corner : corners) {
      add(" ");
      add_number(corner + 1);
    }
    add("\n");
  }
};

class PlySink final : public MeshSink {
 public:
  using MeshSink::MeshSink;
  void begin(const MeshSize& size) override {
    add("ply\nformat binary_little_endian 1.0\n"
        "comment a landfall terrain: metres, x right, y up on the map, z up\n"
        "element vertex ");
    add_number(size.vertices);
    add("\nproperty double x\nproperty double y\nproperty double z\nelement face ");
    add_number(size.triangles);
    add("\nproperty list uchar int vertex_indices\nend_header\n");
  }
  void vertex(const Eigen::Vector3d& point) override {
    for (const double coordinate : point) add_bytes(coordinate);
  }
  void triangle(const TriangleCorners& corners) override {
    add_bytes(std::uint8_t{3});
    for (const std::uint32_t corner : corners) add_bytes(corner);
  }
};

/// The triangles of a grid, row by row, with numbers for the nodes that they use.
class GridRows {
 public:
  explicit GridRows(const TriangulatedGrid& grid)
      : nodes_(grid.nodes()), spec_(nodes_.spec()), cols_(static_cast<std::size_t>(spec_.cols)) {}

  [[nodiscard]] MeshSize size(const ProgressCallback& progress) const {
    MeshSize size;
    for (std::int64_t row = 0; row < spec_.rows; ++row) {
      for (const bool used : used_nodes(row)) size.vertices += used ? 1U : 0U;
      for_each_triangle(row, [&](const std::array<BinIndex, 3>&) { ++size.triangles; });
      report_row(progress, row);
    }
    return size;
  }

  void write_vertices(MeshSink& sink, const ProgressCallback& progress) const {
    for (std::int64_t row = 0; row < spec_.rows; ++row) {
      const std::vector<bool> used = used_nodes(row);
      for (std::int64_t col = 0; col < spec_.cols; ++col)
        if (used[static_cast<std::size_t>(col)])
          sink.vertex({spec_.x(col), spec_.y(row), nodes_.at({row, col})});
      report_row(progress, row);
    }
  }

  void write_triangles(MeshSink& sink, const ProgressCallback& progress) const {
    std::uint32_t next = 0;
    std::vector<std::uint32_t> south = numbers(0, next);
    for (std::int64_t row = 0; row + 1 < spec_.rows; ++row) {
      const std::vector<std::uint32_t> north = numbers(row + 1, next);
      for_each_triangle(row, [&](const std::array<BinIndex, 3>& corners) {
        TriangleCorners t{};
        for (std::size_t i = 0; i < 3; ++i)
          t[i] = (corners[i].row == row ? south : north)[static_cast<std::size_t>(corners[i].col)];
        sink.triangle(t);
      });
      south = north;
      report_row(progress, row);
    }
  }

 private:
  /// Calls f(corners) for the triangles between a row and the one above, counter-clockwise.
  template <class F>
  void for_each_triangle(std::int64_t row, const F& f) const {
    if (row < 0 || row + 1 >= spec_.rows) return;
    for (std::int64_t col = 0; col + 1 < spec_.cols; ++col) {
      const BinIndex a{row, col};
      const BinIndex b{row, col + 1};
      const BinIndex c{row + 1, col};
      const BinIndex d{row + 1, col + 1};
      if (!std::isfinite(nodes_.at(b)) || !std::isfinite(nodes_.at(c))) continue;  // both need the diagonal
      if (std::isfinite(nodes_.at(a))) f(std::array{a, b, c});
      if (std::isfinite(nodes_.at(d))) f(std::array{b, d, c});
    }
  }

  [[nodiscard]] std::vector<bool> used_nodes(std::int64_t row) const {
    std::vector<bool> used(cols_);
    const auto mark = [&](const std::array<BinIndex, 3>& corners) {
      for (const BinIndex& corner : corners)
        if (corner.row == row) used[static_cast<std::size_t>(corner.col)] = true;
    };
    for_each_triangle(row - 1, mark);
    for_each_triangle(row, mark);
    return used;
  }

  /// The numbers of a row's nodes, from `next` on; those of unused nodes mean nothing.
  [[nodiscard]] std::vector<std::uint32_t> numbers(std::int64_t row, std::uint32_t& next) const {
    std::vector<std::uint32_t> result;
    for (const bool used : used_nodes(row)) {
      result.push_back(next);
      next += used ? 1U : 0U;
    }
    return result;
  }

  void report_row(const ProgressCallback& progress, std::int64_t row) const {
    if (row % kRowsPerReport == 0)
      report(progress, static_cast<double>(row) / static_cast<double>(spec_.rows));
  }

  const Grid<double>& nodes_;
  const GridSpec& spec_;
  std::size_t cols_;
};

void write_grid(const TriangulatedGrid& grid, const std::string& name, MeshSink& sink,
                const ProgressCallback& progress) {
  const GridRows rows(grid);
  const auto third = [&](double from) -> ProgressCallback {
    return [&progress, from](double fraction) { report(progress, (from + fraction) / 3); };
  };
  const MeshSize size = rows.size(third(0));
  if (size.triangles == 0)
    throw FormatError("output " + name + ": the terrain has no triangle without a hole");
  if (std::max(size.vertices, size.triangles) > kMaxMeshElements)
    throw FormatError("output " + name + ": more than 2^31 - 1 vertices or triangles");
  sink.begin(size);
  rows.write_vertices(sink, third(1));
  rows.write_triangles(sink, third(2));
}

void write_triangles(const IndexedTriangles& mesh, MeshSink& sink, const ProgressCallback& progress) {
  sink.begin({mesh.vertices.size(), mesh.triangles.size()});
  for (const Eigen::Vector3d& vertex : mesh.vertices) sink.vertex(vertex);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    sink.triangle(mesh.triangles[i]);
    if (i % kElementsPerReport == 0)
      report(progress, static_cast<double>(i) / static_cast<double>(mesh.triangles.size()));
  }
}

std::unique_ptr<MeshSink> sink_for(const OutputPath& output) {
  if (file_extension(output.path()) == ".obj") return std::make_unique<ObjSink>(output.temporary());
  return std::make_unique<PlySink>(output.temporary());
}

}  // namespace

void write_mesh_file(const OutputOptions& options, const TerrainSurface& surface,
                     const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  const std::unique_ptr<MeshSink> sink = sink_for(output);
  if (const auto* const grid = dynamic_cast<const TriangulatedGrid*>(&surface))
    write_grid(*grid, options.path.string(), *sink, progress);
  else if (const auto* const mesh = dynamic_cast<const TriangleMesh*>(&surface))
    write_triangles(mesh->data(), *sink, progress);
  else
    throw FormatError("output " + options.path.string() +
                      ": this kind of terrain cannot be written as a mesh");
  if (!sink->close())
    throw IoError("output " + options.path.string() +
                  ": writing failed: " + std::generic_category().message(errno));
  output.commit();
  report(progress, 1);
}

}  // namespace landfall
