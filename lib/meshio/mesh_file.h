// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/progress.h"
#include "output/output_path.h"
#include "terrain/mesh/polygon_soup.h"
#include "terrain/surface.h"

namespace landfall {

/// What a mesh file holds.
struct MeshFile {
  PolygonSoup soup;
  std::string content_id;  ///< the hash of the file's bytes, as content_id() has it
};

/// Reads Wavefront OBJ, PLY (ASCII and binary of either order), OFF and STL (ASCII and binary), told apart by
/// the name's end (.obj, .ply, .off, .stl, in any case). Normals, colours, texture, groups and materials are
/// passed over, and a material file is never opened.
///
/// Throws FormatError, naming the file, the line or the offset, and what is wrong: no regular file, another
/// extension, a format that the extension does not promise, a number or an index that is none, a file that
/// ends too early. Nothing is allocated by a count that the file claims. What the soup then holds, points
/// that are not finite and corners that are no points among it, is for clean_mesh() to judge.
[[nodiscard]] MeshFile read_mesh_file(const std::filesystem::path& path);

/// One parser each; `name` begins messages. (read_mesh_file() chooses.)
[[nodiscard]] PolygonSoup parse_obj(std::string_view text, const std::string& name);
[[nodiscard]] PolygonSoup parse_off(std::string_view text, const std::string& name);
[[nodiscard]] PolygonSoup parse_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] PolygonSoup parse_ply(std::string_view bytes, const std::string& name);

/// Writes a terrain as a mesh, metres, frame D: OBJ where the name ends in .obj, else binary little-endian
/// PLY (float64). A grid gives its triangles as D6 splits them; triangles with a NaN corner are left out, and
/// nodes of no triangle. Row by row: no second copy of the grid. The file appears under its name only when it
/// is complete. Coordinates come back bit for bit.
///
/// Throws UsageError where the output cannot be, FormatError where no triangle is left or there are more than
/// 2^31 - 1 vertices or triangles, IoError where the disk refuses.
void write_mesh_file(const OutputOptions& options, const TerrainSurface& surface,
                     const ProgressCallback& progress = {});

}  // namespace landfall
