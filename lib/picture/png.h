// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "output/output_path.h"
#include "raster/rgb_image.h"

namespace landfall {

/// Writes an image as an 8-bit RGB PNG that appears complete or not at all (output_path.h). Equal images give
/// equal bytes. Throws UsageError if the output exists, IoError, naming the output, if it cannot be written
/// or the image has no pixels. The compression level of `output` is not used.
void write_png(const OutputOptions& output, const RgbImage& image);

}  // namespace landfall
