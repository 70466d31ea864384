// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/core/progress.h"
#include "base/output/output_path.h"
#include "chain/terrain/mesh/polygon_soup.h"
#include "chain/terrain/relief/triangulated_grid.h"
#include "formats/mesh/up_axis.h"

namespace landfall {

/// The contents of a mesh file.
struct MeshFile {
  PolygonSoup soup;
  std::string content_id;    ///< the hash of the file's bytes, as from content_id()
  PlaceComments comments{};  ///< not of STL, whose bytes may be binary
};

/// Reads Wavefront OBJ, PLY (ASCII and binary of either byte order), OFF and STL (ASCII and binary), and
/// shape models of the Planetary Data System with the lines of an OBJ, identified by the file extension
/// (.obj, .ply, .off, .stl, .tab, in upper or lower case). Normals, colours, texture, groups and materials
/// are ignored, and material files are never opened.
///
/// Every part of the shape is read or refused: facets of any number of corners, several solids of an STL,
/// triangle strips of a PLY; points, lines and free-form geometry are refused, and so is whatever follows the
/// last element that the file declares. PolygonSoup::unread names other elements of a PLY.
///
/// Throws FormatError, naming the file, the line or the offset, and the error: not a regular file, an unknown
/// extension, a format that differs from the extension, an invalid number or index, a file that ends too
/// early. Memory is never allocated from a count that the file claims. The content of the soup is not
/// checked: clean_mesh() handles points that are not finite and corners that refer to no point.
[[nodiscard]] MeshFile read_mesh_file(const std::filesystem::path& path);

/// One parser per format; `name` begins messages. read_mesh_file() chooses the parser.
[[nodiscard]] PolygonSoup parse_obj(std::string_view text, const std::string& name);
[[nodiscard]] PolygonSoup parse_off(std::string_view text, const std::string& name);
[[nodiscard]] PolygonSoup parse_stl(std::string_view bytes, const std::string& name);
[[nodiscard]] PolygonSoup parse_ply(std::string_view bytes, const std::string& name);
/// An OBJ that may be a .tab. Throws FormatError for a table that does not begin as an OBJ does.
[[nodiscard]] PolygonSoup parse_shape_table(std::string_view text, const std::string& name);

/// Writes a terrain as a mesh, metres, frame D: OBJ if the name ends in .obj, else binary little-endian PLY
/// (float64). A grid gives its triangles as D6 splits them, without triangles that have a NaN corner and
/// without unused nodes. Writes row by row, without a second copy of the grid. The file appears under its
/// name only when it is complete. Coordinates are read back bit for bit.
///
/// Throws UsageError if the output path is refused, FormatError if no triangle is left or there are more than
/// 2^31 - 1 vertices or triangles, IoError if writing fails.
void write_mesh_file(const OutputOptions& options, const TriangulatedGrid& grid,
                     const ProgressCallback& progress = {});
void write_mesh_file(const OutputOptions& options, const IndexedTriangles& mesh,
                     const ProgressCallback& progress = {});

}  // namespace landfall
