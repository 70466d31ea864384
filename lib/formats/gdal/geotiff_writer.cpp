// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D131, D161
#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <type_traits>
#include <variant>
#include <vector>

#include "base/core/error.h"
#include "formats/gdal/gdal_crs.h"
#include "formats/gdal/gdal_errors.h"
#include "formats/gdal/plugin.h"
#include "formats/gdal/registry.h"

namespace landfall {
namespace {

constexpr int kBlock = 512;

/// Divides `count` nodes evenly into `parts` pixels: pixel `i` covers the nodes first(i) .. first(i + 1) - 1.
struct Division {
  std::int64_t count;
  std::int64_t parts;
  [[nodiscard]] std::int64_t first(std::int64_t i) const { return (2 * i * count + parts) / (2 * parts); }
};

std::int64_t coarser(std::int64_t count, int level) {
  const std::int64_t factor = std::int64_t{1} << level;
  return (count + factor - 1) / factor;
}

const GridSpec& spec_of(const GeotiffContent& content) {
  return std::visit([](const auto* grid) -> const GridSpec& { return grid->spec(); },
                    content.bands.front().values);
}

/// The common type of all bands.
GDALDataType type_of(const GeotiffContent& content) {
  const auto any = [&content]<class T>(T /*of*/) {
    return std::any_of(content.bands.begin(), content.bands.end(), [](const GeotiffBand& band) {
      return std::holds_alternative<const Grid<T>*>(band.values);
    });
  };
  if (any(double{}) || (any(float{}) && any(std::int32_t{}))) return GDT_Float64;
  if (any(float{})) return GDT_Float32;
  return any(std::int32_t{}) ? GDT_Int32 : GDT_Int16;
}

/// A level of a grid: 0 is the grid itself, n > 0 an overview, about 2^n times coarser.
struct Level {
  int level;
  Division rows;
  Division cols;

  Level(const GridSpec& spec, int number)
      : level(number),
        rows{spec.rows, coarser(spec.rows, number)},
        cols{spec.cols, coarser(spec.cols, number)} {}
};

/// The mean of a pixel's nodes that are not holes. Row 0 is the northern one.
template <class T>
double mean_of(const Grid<T>& nodes, const Level& level, std::int64_t row, std::int64_t col) {
  const std::int64_t last = nodes.spec().rows - 1;
  double sum = 0;
  std::int64_t count = 0;
  for (std::int64_t r = level.rows.first(row); r < level.rows.first(row + 1); ++r)
    for (std::int64_t c = level.cols.first(col); c < level.cols.first(col + 1); ++c) {
      const double z = nodes.at({last - r, c});
      if (std::isnan(z)) continue;
      sum += z;
      ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

template <class T>
double pixel(const Grid<T>& nodes, const Level& level, std::int64_t row, std::int64_t col) {
  const std::int64_t last = nodes.spec().rows - 1;
  if (level.level == 0) return nodes.at({last - row, col});
  if constexpr (std::is_floating_point_v<T>) return mean_of(nodes, level, row, col);
  return nodes.at({last - (level.rows.first(row) + level.rows.first(row + 1)) / 2,
                   (level.cols.first(col) + level.cols.first(col + 1)) / 2});
}

/// The part of a band that is read at a time.
struct Block {
  std::int64_t first_row;
  std::int64_t first_col;
  std::int64_t rows;
  std::int64_t cols;
};

template <class Out, class T>
void fill(const Grid<T>& nodes, const Level& level, const Block& block, void* out) {
  auto* const values = static_cast<Out*>(out);
  for (std::int64_t row = 0; row < block.rows; ++row)
    for (std::int64_t col = 0; col < block.cols; ++col)
      values[row * kBlock + col] =
          static_cast<Out>(pixel(nodes, level, block.first_row + row, block.first_col + col));
}

template <class T>
void fill(GDALDataType type, const Grid<T>& nodes, const Level& level, const Block& block, void* out) {
  switch (type) {
    case GDT_Float64:
      return fill<double>(nodes, level, block, out);
    case GDT_Float32:
      return fill<float>(nodes, level, block, out);
    case GDT_Int32:
      return fill<std::int32_t>(nodes, level, block, out);
    default:
      return fill<std::int16_t>(nodes, level, block, out);
  }
}

/// Presents grids to GDAL without a copy: north up, each node at the centre of its pixel.
class GridDataset final : public GDALDataset {
 public:
  GridDataset(const GeotiffContent& content, int level);

  CPLErr GetGeoTransform(double* coefficients) override {
    const double s = spec_.resolution_m;
    const double values[] = {spec_.x(0) - s / 2, s, 0, spec_.y(spec_.rows - 1) + s / 2, 0, -s};
    std::copy(std::begin(values), std::end(values), coefficients);
    return CE_None;
  }
  const OGRSpatialReference* GetSpatialRef() const override { return &crs_; }

  /// The overviews of the full grid, finest first.
  std::vector<std::unique_ptr<GridDataset>> overviews;

  [[nodiscard]] const Level& level() const { return level_; }

 private:
  const GridSpec& spec_;
  OGRSpatialReference crs_;
  Level level_;
};

class GridBand final : public GDALRasterBand {
 public:
  GridBand(GridDataset& dataset, const GeotiffBand& band, GDALDataType type)
      : dataset_(dataset), band_(band) {
    poDS = &dataset;
    eDataType = type;
    nRasterXSize = dataset.GetRasterXSize();
    nRasterYSize = dataset.GetRasterYSize();
    nBlockXSize = kBlock;
    nBlockYSize = kBlock;
    if (!band.name.empty()) SetDescription(band.name.c_str());
  }
  double GetNoDataValue(int* given) override {
    const bool is_real = eDataType == GDT_Float64 || eDataType == GDT_Float32;
    if (given != nullptr) *given = is_real ? TRUE : FALSE;
    return std::numeric_limits<double>::quiet_NaN();
  }
  const char* GetUnitType() override { return band_.unit.c_str(); }
  int GetOverviewCount() override { return static_cast<int>(dataset_.overviews.size()); }
  GDALRasterBand* GetOverview(int i) override {
    return i >= 0 && i < GetOverviewCount()
               ? dataset_.overviews[static_cast<std::size_t>(i)]->GetRasterBand(nBand)
               : nullptr;
  }

 protected:
  CPLErr IReadBlock(int block_col, int block_row, void* out) override {
    const Block block{std::int64_t{block_row} * kBlock, std::int64_t{block_col} * kBlock,
                      std::min(kBlock, nRasterYSize - block_row * kBlock),
                      std::min(kBlock, nRasterXSize - block_col * kBlock)};
    std::visit([&](const auto* nodes) { fill(eDataType, *nodes, dataset_.level(), block, out); },
               band_.values);
    return CE_None;
  }

 private:
  GridDataset& dataset_;
  const GeotiffBand& band_;
};

GridDataset::GridDataset(const GeotiffContent& content, int level)
    : spec_(spec_of(content)), level_(spec_, level) {
  nRasterXSize = static_cast<int>(level_.cols.parts);
  nRasterYSize = static_cast<int>(level_.rows.parts);
  crs_ = crs_to_export(content.crs_wkt);
  const GDALDataType type = type_of(content);
  int number = 0;
  for (const GeotiffBand& band : content.bands)
    SetBand(++number, new GridBand(*this, band, type));  // the dataset owns its bands
}

/// Full grid and overviews, since GDAL would compute overviews in a temporary file.
std::unique_ptr<GridDataset> source_of(const GeotiffContent& content) {
  auto source = std::make_unique<GridDataset>(content, 0);
  const GridSpec& spec = spec_of(content);
  for (int level = 1; coarser(std::max(spec.rows, spec.cols), level - 1) > kBlock; ++level)
    source->overviews.push_back(std::make_unique<GridDataset>(content, level));
  source->SetMetadataItem("AREA_OR_POINT", "Area");
  source->SetMetadataItem("TIFFTAG_SOFTWARE", content.software.c_str());
  source->SetMetadataItem("LANDFALL_FILE_ID", content.file_id.c_str());
  return source;
}

CPLStringList creation_options(const GeotiffOptions& options) {
  CPLStringList list;
  list.SetNameValue("COMPRESS", options.compression > 0 ? "DEFLATE" : "NONE");
  if (options.compression > 0) {
    list.SetNameValue("LEVEL", std::to_string(options.compression).c_str());
    list.SetNameValue("PREDICTOR", "YES");
  }
  list.SetNameValue("BLOCKSIZE", std::to_string(kBlock).c_str());
  list.SetNameValue("BIGTIFF", "IF_SAFER");
  list.SetNameValue("NUM_THREADS", std::to_string(options.threads).c_str());
  return list;
}

int CPL_STDCALL tell_progress(double fraction, const char* /*message*/, void* callback) {
  report(*static_cast<const ProgressCallback*>(callback), fraction);
  return TRUE;
}

}  // namespace

void write_cloud_optimized_geotiff(const std::string& path, const GeotiffContent& content,
                                   const GeotiffOptions& options, const ProgressCallback& progress) {
  prepare_gdal_to_write();
  GdalErrors errors;
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("COG");
  if (driver == nullptr) throw IoError("this GDAL has no COG driver");
  CPLConfigOptionSetter no_sidecar("GDAL_PAM_ENABLED", "NO", false);
  const std::unique_ptr<GridDataset> source = source_of(content);
  ProgressCallback told = progress;
  GDALDatasetUniquePtr written(driver->CreateCopy(path.c_str(), source.get(), FALSE,
                                                  creation_options(options).List(), tell_progress, &told));
  const bool made = written != nullptr;
  written.reset();  // flushes the buffers, so that errors are known
  if (!made || errors.any()) throw IoError("writing failed: " + errors.reason());
}

}  // namespace landfall
