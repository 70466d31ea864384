// SPDX-License-Identifier: GPL-3.0-or-later
#include "exports/geotiff.h"

#include "base/parallel.h"
#include "base/thread_supply.h"
#include "terrain/gdal/gdal_loader.h"

namespace landfall {

void write_geotiff(const OutputOptions& options, const GeotiffContent& content,
                   const ProgressCallback& progress) {
  OutputPath output(options.path, options.overwrite);
  save_geotiff(output.temporary().string(), content, {options.compression, thread_supply(thread_count())},
               progress);
  output.commit();
}

}  // namespace landfall
