// SPDX-License-Identifier: GPL-3.0-or-later
// Mesh files are read by our own parsers. CGAL's (5.5) silently drop corners (OBJ with tabs), accept an
// index beyond the end, and allocate lists of the length that the file declares.
//
// Every element of a mesh file is read or refused, because a missing part is a wrong terrain that looks
// right. Points, lines, and free-form geometry are refused, as is a vertex with a weight other than 1,
// which some programs divide by and others ignore, and everything behind the last element that the file
// declares. Other elements of a PLY, such as a camera, have no shape: a warning names them.
#include "formats/mesh/mesh_file.h"

#include <fstream>
#include <span>

#include "base/core/error.h"
#include "base/core/hash.h"
#include "base/text/file_path.h"
#include "base/text/foreign_content.h"
#include "base/text/shown_text.h"

namespace landfall {
namespace {

namespace fs = std::filesystem;

std::string read_bytes(const fs::path& path) {
  const std::string name = path.string();
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FormatError(name + ": cannot be read");
  std::string bytes(fs::file_size(path), '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (stream.gcount() != static_cast<std::streamsize>(bytes.size()))
    throw FormatError(name + ": cannot be read completely");
  return bytes;
}

}  // namespace

MeshFile read_mesh_file(const fs::path& path) {
  const std::string name = path.string();
  const std::string extension = file_extension(path);
  const auto parse = extension == ".obj"   ? parse_obj
                     : extension == ".ply" ? parse_ply
                     : extension == ".off" ? parse_off
                     : extension == ".stl" ? parse_stl
                     : extension == ".tab" ? parse_shape_table
                                           : nullptr;
  if (parse == nullptr)
    throw FormatError(name + ": '" + shown_word(extension) +
                      "' is not a supported mesh format: use .obj, .ply, .off, .stl or .tab");
  const std::string bytes = read_bytes(path);
  const std::string foreign = foreign_content(bytes);
  if (!foreign.empty() && extension != ".stl") throw FormatError(name + ": " + foreign);
  MeshFile file{parse(bytes, name), Hash().update(std::as_bytes(std::span(bytes))).hex(),
                extension == ".stl" ? PlaceComments{} : place_comments(bytes)};
  if (file.soup.polygon_ends.empty() && !file.soup.points.empty())
    throw FormatError(name + ": has " + std::to_string(file.soup.points.size()) +
                      " vertices but no facet: a point cloud must be meshed, or gridded as a raster, first");
  return file;
}

}  // namespace landfall
