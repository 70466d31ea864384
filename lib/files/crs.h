// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "hdf5/h5.h"

namespace landfall {

/// The CF grid mapping /crs: a scalar whose attribute crs_wkt is the site frame. An empty `wkt` writes the
/// local frame of a site without a CRS.
void write_crs(hid_t root, const std::string& wkt);

/// The site frame; the local frame if the file gives none.
[[nodiscard]] std::string read_crs(hid_t root);

}  // namespace landfall
