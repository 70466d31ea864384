// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <string>

#include "hdf5/guard/metadata_guard.h"

namespace landfall::h5 {

/// Checks an HDF5 file before a reader opens its objects: all data must be in the named file, readable by
/// this program alone, and of limited size.
///
/// Visits all objects but reads no values. Follows only hard links, so that no other file is opened. Throws
/// FormatError, which begins with `name` and names the path within the file, for
/// - a link that is not hard: external (naming its target), soft, user-defined;
/// - a virtual dataset, and one that keeps its values in other files (naming the first);
/// - a filter that is not part of HDF5 itself: plug-ins are programs, and are never loaded;
/// - chunks of more than 256 MiB;
/// - more than 256 MiB of values, if more than deflate could hold in the stored bytes;
/// - more than 2^20 objects, or a group that cannot be listed.
/// `guard`, which was made before the file was opened, checks each object before HDF5 reads it.
void screen_file(hid_t file, const std::string& name, MetadataGuard& guard);

}  // namespace landfall::h5
