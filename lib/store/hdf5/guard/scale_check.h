// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <optional>
#include <string>

namespace landfall::h5 {

/// Checks the attributes by which HDF5 links layers to their coordinates (dimension scales): CLASS, NAME,
/// REFERENCE_LIST, DIMENSION_LIST and DIMENSION_LABELS. libhdf5_hl, which h5py and netCDF use, reads them
/// into memory of the size that they should have. Returns the first one of another type or shape, and the
/// form that it should have ("NAME is not one text of fixed length"). The references themselves are not
/// followed.
[[nodiscard]] std::optional<std::string> scale_fault(hid_t dataset);

}  // namespace landfall::h5
