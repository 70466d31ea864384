// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>

namespace landfall {

/// A shared library of landfall that a program loads only when it needs it, because of the libraries that it
/// depends on.
struct PluginFile {
  const char* file;        ///< "landfall-gdal.so"
  const char* name;        ///< in messages: "GDAL"
  const char* needed_by;   ///< in messages: "rasters need"
  const char* symbol;      ///< of its one object, which begins with `const char* version`
  std::size_t headroom;    ///< bytes; some libraries crash with less memory
  const char* remedy{""};  ///< ends the message if a library that the plugin needs is missing
};

/// The plugin's object. The plugin is searched for in $LANDFALL_PLUGIN_DIR, then beside the library that
/// has this code, then next to the running program (../lib/landfall and ../<libdir>/landfall), then in the
/// installation folder. It is never unloaded because
/// its libraries keep pointers into themselves; a caller keeps the result, since each call searches again.
///
/// Throws IoError, naming the paths tried, if there is none, if it cannot be loaded, or if it is of another
/// version than the program.
[[nodiscard]] const void* load_plugin(const PluginFile& wanted);

}  // namespace landfall
