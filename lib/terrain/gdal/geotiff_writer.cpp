// SPDX-License-Identifier: GPL-3.0-or-later
#include "terrain/gdal/geotiff_writer.h"

#include <cpl_conv.h>
#include <cpl_string.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <vector>

#include "base/error.h"
#include "terrain/gdal/gdal_errors.h"
#include "terrain/gdal/registry.h"

namespace landfall {
namespace {

constexpr int kBlock = 512;

/// Pixel `i` of `parts` that share `count` nodes evenly covers the nodes first(i) .. first(i + 1) - 1.
struct Division {
  std::int64_t count;
  std::int64_t parts;
  [[nodiscard]] std::int64_t first(std::int64_t i) const { return (2 * i * count + parts) / (2 * parts); }
};

class GridBand;

/// A grid as GDAL sees it, without a copy: north up, each node the centre of its pixel. At level n > 0 an
/// overview, about 2^n times coarser: pixels are the mean of their nodes that are no holes.
class GridDataset final : public GDALDataset {
 public:
  GridDataset(const GeotiffContent& content, int level);

  CPLErr GetGeoTransform(double* coefficients) override {
    const GridSpec& spec = nodes_.spec();
    const double s = spec.resolution_m;
    const double values[] = {spec.x(0) - s / 2, s, 0, spec.y(spec.rows - 1) + s / 2, 0, -s};
    std::copy(std::begin(values), std::end(values), coefficients);
    return CE_None;
  }
  const OGRSpatialReference* GetSpatialRef() const override { return &crs_; }

  /// The overviews of the full grid, finest first.
  std::vector<std::unique_ptr<GridDataset>> overviews;

  [[nodiscard]] double value(std::int64_t row, std::int64_t col) const;

 private:
  const Grid<double>& nodes_;
  OGRSpatialReference crs_;
  int level_;
  Division rows_;
  Division cols_;
};

class GridBand final : public GDALRasterBand {
 public:
  explicit GridBand(GridDataset& dataset) : dataset_(dataset) {
    poDS = &dataset;
    nBand = 1;
    eDataType = GDT_Float64;
    nRasterXSize = dataset.GetRasterXSize();
    nRasterYSize = dataset.GetRasterYSize();
    nBlockXSize = kBlock;
    nBlockYSize = kBlock;
  }
  double GetNoDataValue(int* given) override {
    if (given != nullptr) *given = TRUE;
    return std::numeric_limits<double>::quiet_NaN();
  }
  const char* GetUnitType() override { return "m"; }
  int GetOverviewCount() override { return static_cast<int>(dataset_.overviews.size()); }
  GDALRasterBand* GetOverview(int i) override {
    return i >= 0 && i < GetOverviewCount()
               ? dataset_.overviews[static_cast<std::size_t>(i)]->GetRasterBand(1)
               : nullptr;
  }

 protected:
  CPLErr IReadBlock(int block_col, int block_row, void* out) override {
    auto* const values = static_cast<double*>(out);
    const int rows = std::min(kBlock, nRasterYSize - block_row * kBlock);
    const int cols = std::min(kBlock, nRasterXSize - block_col * kBlock);
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < cols; ++col)
        values[row * kBlock + col] = dataset_.value(block_row * kBlock + row, block_col * kBlock + col);
    return CE_None;
  }

 private:
  GridDataset& dataset_;
};

std::int64_t coarser(std::int64_t count, int level) {
  const std::int64_t factor = std::int64_t{1} << level;
  return (count + factor - 1) / factor;
}

GridDataset::GridDataset(const GeotiffContent& content, int level)
    : nodes_(content.nodes),
      level_(level),
      rows_{nodes_.spec().rows, coarser(nodes_.spec().rows, level)},
      cols_{nodes_.spec().cols, coarser(nodes_.spec().cols, level)} {
  nRasterXSize = static_cast<int>(cols_.parts);
  nRasterYSize = static_cast<int>(rows_.parts);
  if (crs_.importFromWkt(content.crs_wkt.c_str()) != OGRERR_NONE) crs_.Clear();
  crs_.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  SetBand(1, new GridBand(*this));  // the dataset owns its bands
}

/// Row 0 is the northern one.
double GridDataset::value(std::int64_t row, std::int64_t col) const {
  const std::int64_t last = nodes_.spec().rows - 1;
  if (level_ == 0) return nodes_.at({last - row, col});
  double sum = 0;
  std::int64_t count = 0;
  for (std::int64_t r = rows_.first(row); r < rows_.first(row + 1); ++r)
    for (std::int64_t c = cols_.first(col); c < cols_.first(col + 1); ++c) {
      const double z = nodes_.at({last - r, c});
      if (std::isnan(z)) continue;
      sum += z;
      ++count;
    }
  return count > 0 ? sum / static_cast<double>(count) : std::numeric_limits<double>::quiet_NaN();
}

/// Full grid and overviews: GDAL would compute these in a temporary file of its own.
std::unique_ptr<GridDataset> source_of(const GeotiffContent& content) {
  auto source = std::make_unique<GridDataset>(content, 0);
  const GridSpec& spec = content.nodes.spec();
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
  prepare_gdal("");
  GdalErrors errors;
  GDALDriver* const driver = GetGDALDriverManager()->GetDriverByName("COG");
  if (driver == nullptr) throw IoError("this GDAL has no COG driver");
  CPLConfigOptionSetter no_sidecar("GDAL_PAM_ENABLED", "NO", false);
  const std::unique_ptr<GridDataset> source = source_of(content);
  ProgressCallback told = progress;
  GDALDatasetUniquePtr written(driver->CreateCopy(path.c_str(), source.get(), FALSE,
                                                  creation_options(options).List(), tell_progress, &told));
  const bool made = written != nullptr;
  written.reset();  // what is still in buffers is written now
  if (!made || errors.any()) throw IoError("writing failed: " + errors.reason());
}

}  // namespace landfall
