// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace landfall {

/// How to treat files that a raster refers to but that do not belong to it, such as the sources of a VRT.
///
/// Part of a raster are the file itself, and files in its folder whose names begin with its own up to the
/// last dot: the image of a detached label, headers, world files, masks. Of an archive it is the archive, of
/// a folder all that lies in it.
enum class RasterLinks { refused, followed };

}  // namespace landfall
