// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/output/byte_sink.h"
#include "base/text/file_path.h"
#include "base/text/number_text.h"
#include "chain/terrain/mesh/indexed_triangles.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "formats/mesh/mesh_file.h"

namespace landfall {
namespace {

constexpr std::int64_t kRowsPerReport = 64;
constexpr std::size_t kElementsPerReport = 1U << 16U;

struct MeshSize {
  std::size_t vertices = 0;
  std::size_t triangles = 0;
};

/// Receives a mesh: its vertices in order, then its triangles.
class MeshSink {
 public:
  explicit MeshSink(FileSink& file) : file_(file) {}
  virtual ~MeshSink() = default;
  MeshSink(const MeshSink&) = delete;
  MeshSink& operator=(const MeshSink&) = delete;

  virtual void begin(const MeshSize& size) = 0;
  virtual void vertex(const Eigen::Vector3d& point) = 0;
  virtual void triangle(const TriangleCorners& corners) = 0;

  /// Call after the last triangle.
  void flush() {
    file_.write(text_);
    text_.clear();
  }

 protected:
  /// The buffer to append to.
  std::string& text() {
    if (text_.size() > kBuffer) flush();
    return text_;
  }

 private:
  static constexpr std::size_t kBuffer = 1U << 20U;

  FileSink& file_;
  std::string text_;
};

class ObjSink final : public MeshSink {
 public:
  using MeshSink::MeshSink;
  void begin(const MeshSize&) override {
    text() += "# a landfall terrain: metres, x right, y up on the map, z up\n";
  }
  void vertex(const Eigen::Vector3d& point) override { add_line("v", point); }
  void triangle(const TriangleCorners& corners) override {
    add_line("f", std::array{corners[0] + 1, corners[1] + 1, corners[2] + 1});
  }

 private:
  template <class Numbers>
  void add_line(const char* word, const Numbers& numbers) {
    std::string& line = text() += word;
    for (const auto number : numbers) append_number(line += ' ', number);
    line += '\n';
  }
};

class PlySink final : public MeshSink {
 public:
  using MeshSink::MeshSink;
  void begin(const MeshSize& size) override {
    text() +=
        "ply\nformat binary_little_endian 1.0\n"
        "comment a landfall terrain: metres, x right, y up on the map, z up\n"
        "element vertex " +
        std::to_string(size.vertices) +
        "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
        std::to_string(size.triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
  }
  void vertex(const Eigen::Vector3d& point) override {
    for (const double coordinate : point) append_raw(text(), coordinate);
  }
  void triangle(const TriangleCorners& corners) override {
    append_raw(text(), std::uint8_t{3});
    for (const std::uint32_t corner : corners) append_raw(text(), corner);
  }
};

/// The triangles of a grid, row by row, with indices for the nodes that they use.
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

  /// The indices of a row's nodes, from `next` on; those of unused nodes are not valid.
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

void write_terrain(const TriangulatedGrid& grid, const std::string& name, MeshSink& sink,
                   const ProgressCallback& progress) {
  const GridRows rows(grid);
  const auto third = [&](double from) -> ProgressCallback {
    return [&progress, from](double fraction) { report(progress, (from + fraction) / 3); };
  };
  const MeshSize size = rows.size(third(0));
  if (size.triangles == 0)
    throw FormatError("output " + name + ": every cell has a hole; there is no triangle to write");
  if (std::max(size.vertices, size.triangles) > kMaxMeshElements)
    throw FormatError("output " + name + ": more than 2^31 - 1 vertices or triangles");
  sink.begin(size);
  rows.write_vertices(sink, third(1));
  rows.write_triangles(sink, third(2));
}

void write_terrain(const IndexedTriangles& mesh, const std::string& /*name*/, MeshSink& sink,
                   const ProgressCallback& progress) {
  sink.begin({mesh.vertices.size(), mesh.triangles.size()});
  for (const Eigen::Vector3d& vertex : mesh.vertices) sink.vertex(vertex);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    sink.triangle(mesh.triangles[i]);
    if (i % kElementsPerReport == 0)
      report(progress, static_cast<double>(i) / static_cast<double>(mesh.triangles.size()));
  }
}

template <class Terrain>
void write_file(const OutputOptions& options, const Terrain& terrain, const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  FileSink file(output);
  ObjSink obj(file);
  PlySink ply(file);
  MeshSink& sink = file_extension(options.path) == ".obj" ? static_cast<MeshSink&>(obj) : ply;
  write_terrain(terrain, options.path.string(), sink, progress);
  sink.flush();
  file.finish();
  report(progress, 1);
}

}  // namespace

void write_mesh_file(const OutputOptions& options, const TriangulatedGrid& grid,
                     const ProgressCallback& progress) {
  write_file(options, grid, progress);
}

void write_mesh_file(const OutputOptions& options, const IndexedTriangles& mesh,
                     const ProgressCallback& progress) {
  write_file(options, mesh, progress);
}

}  // namespace landfall
