// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <string>

namespace landfall::h5 {

/// What every HDF5 file must be before a reader meets it: all of it in the one file that was named, readable
/// by this program alone, and no greater than it can be.
///
/// Walks all objects and reads no values; follows nothing but hard links, so that no other file is opened.
/// Throws FormatError, beginning with `name` and naming the path within the file, for
/// - a link that is not hard: external (naming its target), soft, user-defined;
/// - a virtual dataset, and one that keeps its values in other files (naming the first);
/// - a filter that HDF5 itself has not: its plug-ins are programs, and never loaded;
/// - chunks of more than 256 MiB;
/// - more bytes of values than 256 MiB of which fewer are stored than deflate could make of them;
/// - more than 2^20 objects, or a group that cannot be listed.
/// What cannot be opened, since it is damaged, is left to its reader.
void screen_file(hid_t file, const std::string& name);

}  // namespace landfall::h5
