// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/exports/csv.h"

#include <algorithm>
#include <span>
#include <string>

#include "base/core/parallel.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

/// Lines that one thread writes at a time, and lines that are in memory at a time.
constexpr std::size_t kPieceLines = 8192;
constexpr std::size_t kPieces = 32;

/// Appends lines `begin` to `end`, one for each `every`-th bin of a grid.
void append_bins(const std::vector<NamedLayer>& layers, std::size_t every, std::size_t begin, std::size_t end,
                 std::string& out) {
  const GridSpec& spec =
      std::visit([](const auto& grid) -> const GridSpec& { return grid.spec(); }, layers.front().values);
  const auto cols = static_cast<std::size_t>(spec.cols);
  for (std::size_t line = begin; line < end; ++line) {
    const std::size_t bin = line * every;
    append_number(out, spec.x(static_cast<std::int64_t>(bin % cols)));
    out += ',';
    append_number(out, spec.y(static_cast<std::int64_t>(bin / cols)));
    for (const NamedLayer& layer : layers) {
      out += ',';
      std::visit([&](const auto& grid) { append_number(out, grid.values()[bin]); }, layer.values);
    }
    out += '\n';
  }
}

}  // namespace

void write_points_csv(const PointReader& points, const PointReader::Pass& pass, ByteSink& sink,
                      const ProgressCallback& progress) {
  const auto heading = [&](const std::string& name) { return name_with_unit(points.read_column(name)); };
  sink.write(joined(pass.columns, ",", heading) + "\n");
  // A float32 was read as a double of the same value; the text is the shortest for the float32.
  std::vector<bool> single;
  for (const std::string& name : pass.columns)
    single.push_back(points.read_column(name).type == h5::Type::float32);
  const auto append = [&single](const PointBatch& batch, std::size_t c, std::size_t row, std::string& out) {
    if (single[c]) return append_number(out, static_cast<float>(batch.real(c)[row]));
    std::visit([&](const auto& column) { append_number(out, column[row]); }, batch.columns[c]);
  };
  const auto encode = [&](const PointBatch& batch, std::span<const std::uint32_t> rows, std::string& out) {
    for (const std::uint32_t row : rows) {
      for (std::size_t c = 0; c < batch.columns.size(); ++c) {
        if (c > 0) out += ',';
        append(batch, c, row, out);
      }
      out += '\n';
    }
  };
  write_points(points, pass, encode, sink, progress);
}

void write_layers_csv(const std::vector<NamedLayer>& layers, std::size_t every, ByteSink& sink,
                      const ProgressCallback& progress) {
  const auto heading = [](const NamedLayer& layer) { return name_with_unit(layer.info); };
  sink.write("x_m,y_m," + joined(layers, ",", heading) + "\n");
  const std::size_t bins =
      std::visit([](const auto& grid) { return grid.values().size(); }, layers.front().values);
  const std::size_t lines = (bins + every - 1) / every;
  std::vector<std::string> pieces(kPieces);
  for (std::size_t first = 0; first < lines; first += kPieces * kPieceLines) {
    const std::size_t count = std::min(lines - first, kPieces * kPieceLines);
    parallel_for(count, kPieceLines, [&](std::size_t begin, std::size_t end) {
      std::string& piece = pieces[begin / kPieceLines];
      piece.clear();
      append_bins(layers, every, first + begin, first + end, piece);
    });
    for (std::size_t i = 0; i * kPieceLines < count; ++i) sink.write(pieces[i]);
    report(progress, static_cast<double>(first + count) / static_cast<double>(lines));
  }
}

}  // namespace landfall
