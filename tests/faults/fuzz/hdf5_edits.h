// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include "fuzz_target.h"
#include "landfall_files.h"

namespace landfall::fuzz {

/// Takes edits from `input` until it ends, eight at most, and makes them in an open file, whose content was
/// that of `original`. Each edit is valid HDF5: objects and attributes are deleted, moved, linked, made again
/// with another type, shape, layout, filter or fill value, and filled with other values; texts and the values
/// of JSON texts are replaced; chunks are overwritten with other bytes. What HDF5 refuses is left undone.
void edit(hid_t file, const LandfallFile& original, InputBytes& input);

}  // namespace landfall::fuzz
