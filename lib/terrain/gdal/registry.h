// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace landfall {

/// Makes GDAL ready to open `path` (empty: to write): its drivers registered, its block cache bounded, its
/// messages off stderr on every thread.
///
/// A file's content may name other files, such as the parts of a VRT, but leads to no other machine: unless
/// the path itself names a virtual file system ("/vsi") or a URL ("://"), GDAL's web drivers are not there
/// and /vsicurl/ and its kin open nothing.
void prepare_gdal(const std::string& path);

}  // namespace landfall
