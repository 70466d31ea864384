// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// How to treat files that a raster refers to but that do not belong to it, such as the sources of a VRT.
///
/// The parts of a raster are the file itself and the files in its folder whose names begin with its own up to
/// the last dot: the image of a detached label, headers, world files, masks. For an archive it is the
/// archive, for a folder all files in it.
enum class RasterLinks { refused, followed };

}  // namespace landfall
