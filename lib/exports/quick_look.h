// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "base/progress.h"
#include "files/contents.h"
#include "picture/map_picture.h"

namespace landfall {

/// How a layer or column of this name is drawn: elevations shaded, signed errors in diverging colours about
/// zero, everything else in sequential ones. Flags and numbers of holes keep the greatest value of a pixel's
/// bins, other layers the mean.
[[nodiscard]] MapStyle style_of(const ContentInfo& content);

/// A picture of any landfall file, seen from above, north up, at most 1100 pixels a side and its labels.
/// - A grid: the layer `layer`; empty: its main one (GridSource::main_layer).
/// - A scan: the mean of the column `layer` (the greatest, of flags) over the returns of each pixel at their
///   estimated position, in the frame of the true ones; empty: z_est; `count`: how many returns.
/// - A mesh terrain: H(x, y), the only layer `z`.
/// Throws UsageError for a layer that the file does not have, FormatError as its readers do.
[[nodiscard]] RgbImage quick_look(const std::filesystem::path& input, const std::string& layer,
                                  const ProgressCallback& progress = {});

}  // namespace landfall
