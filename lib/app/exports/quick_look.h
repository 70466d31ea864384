// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "base/core/progress.h"
#include "formats/picture/map_picture.h"
#include "store/files/contents.h"

namespace landfall {

/// The style of a layer of a file of this kind (schemas/dictionary/layers.json); the title of a signed error
/// says its sign. Flags and hole numbers keep the greatest value of a pixel's bins, other layers the mean.
[[nodiscard]] MapStyle style_of(const std::string& kind, const ContentInfo& content);

/// An image of any landfall file, seen from above, north up, at most 1100 pixels a side plus its labels.
/// - A grid: the layer `layer`; if empty, the main layer (GridSource::main_layer). `safe`, `safe_true` and
/// `outcome` of a hazard map are drawn as classes; a pixel of several bins has the worst class of them:
/// missed hazard, hazard (found), false alarm, unknown, safe (found), in this order (D293).
/// - A scan: the mean (for flags: the greatest value) of the column `layer` over the returns of each pixel at
/// their estimated position, in the frame of the true ones; if empty, z_est; `count`: the number of returns.
/// - A mesh terrain: H(x, y), the only layer `z`.
/// Throws UsageError for a layer that the file does not have, and FormatError as the file's readers do.
[[nodiscard]] RgbImage quick_look(const std::filesystem::path& input, const std::string& layer,
                                  const ProgressCallback& progress = {});

}  // namespace landfall
