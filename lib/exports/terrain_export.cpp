// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/terrain_export.h"

#include "base/error.h"
#include "base/file_extension.h"
#include "base/parallel.h"
#include "base/thread_supply.h"
#include "terrain/gdal/gdal_loader.h"

namespace landfall {

TerrainFormat terrain_format(const std::filesystem::path& output) {
  const std::string extension = file_extension(output);
  if (extension == ".h5") return TerrainFormat::landfall;
  if (extension == ".tif" || extension == ".tiff") return TerrainFormat::geotiff;
  if (extension == ".obj" || extension == ".ply") return TerrainFormat::mesh;
  throw UsageError("output " + output.string() + ": extension '" + extension +
                   "' is none of .h5 (terrain), .tif and .tiff (GeoTIFF), .obj and .ply (mesh)");
}

void write_geotiff(const OutputOptions& options, const GeotiffContent& content,
                   const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  save_geotiff(output.temporary().string(), content, {options.compression, thread_supply(thread_count())},
               progress);
  output.commit();
}

bool is_landfall_file(const std::filesystem::path& path) {
  std::error_code unreadable;
  if (!std::filesystem::is_regular_file(path, unreadable)) return false;
  h5::initialise();
  const h5::Handle file = h5::open_for_its_kind(path);
  return file && h5::read_text_attribute(file.get(), "format_name").value_or("").starts_with("landfall.");
}

}  // namespace landfall
