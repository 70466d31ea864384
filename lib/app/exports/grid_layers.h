// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "base/core/progress.h"
#include "base/raster/grid.h"
#include "store/files/contents.h"

namespace landfall {

/// A layer of any supported type; int64 is read as double.
using AnyGrid = std::variant<Grid<double>, Grid<float>, Grid<std::int32_t>, Grid<std::int8_t>>;

struct NamedLayer {
  ContentInfo info;
  AnyGrid values;
};

/// The layers of a terrain, DEM, evaluation, plan or hazard map, for display or export.
class GridSource {
 public:
  /// Throws FormatError unless the file is of one of these kinds and has a grid with a layer: a terrain may
  /// be a mesh, and `dem-eval --metrics-only` writes no layers.
  explicit GridSource(const std::filesystem::path& path);
  GridSource(const GridSource&) = delete;  // the reader refers to the file
  GridSource& operator=(const GridSource&) = delete;

  [[nodiscard]] const LandfallFileReader& file() const { return file_; }
  [[nodiscard]] const std::string& kind() const { return kind_; }
  [[nodiscard]] const GridSpec& spec() const { return reader_.spec(); }
  [[nodiscard]] const std::string& crs_wkt() const { return reader_.crs_wkt(); }
  [[nodiscard]] const std::vector<ContentInfo>& layers() const { return layers_; }

  /// The first layer that is `main` in schemas/dictionary/layers.json; else the first.
  [[nodiscard]] const ContentInfo& main_layer() const;
  /// The layers of these names, in their order; without names: the main layer; for the one name `all`: every
  /// layer. Throws UsageError, listing the existing ones, for an unknown name or one that is given twice.
  [[nodiscard]] std::vector<ContentInfo> choose(const std::vector<std::string>& names) const;

  /// Calls use(rows) with all rows of a layer, from the south. A large float64 layer is read strip by strip,
  /// so that it is never in memory as a whole.
  void read_strips(const ContentInfo& layer, const std::function<void(const AnyGrid& rows)>& use,
                   const ProgressCallback& progress = {}) const;
  [[nodiscard]] AnyGrid read(const ContentInfo& layer, const ProgressCallback& progress = {}) const;
  [[nodiscard]] std::vector<NamedLayer> read(const std::vector<ContentInfo>& layers,
                                             const ProgressCallback& progress = {}) const;

 private:
  LandfallFileReader file_;
  std::string kind_;
  GridLayerReader reader_;
  std::vector<ContentInfo> layers_;
};

}  // namespace landfall
