// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "base/text/file_path.h"

namespace landfall {

/// True for a path with a mesh file's extension: .obj, .ply, .off, .stl or .tab (shape models of the
/// Planetary Data System), in any case.
inline bool is_mesh_name(const std::string& path) {
  const std::string extension = file_extension(path);
  return extension == ".obj" || extension == ".ply" || extension == ".off" || extension == ".stl" ||
         extension == ".tab";
}

}  // namespace landfall
