// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "store/files/landfall_file.h"
#include "store/hdf5/h5.h"

namespace landfall {

/// The description of a site frame that CF-1.8 allows.
enum class CfFrame {
  local,         ///< not tied to a body: no grid mapping exists, and none is needed
  mapped,        ///< described by a grid mapping
  inexpressible  ///< a map projection that CF lacks, or an unknown text
};

/// Writes /crs: a scalar whose attribute crs_wkt is the site frame, with the attributes of a CF grid mapping
/// where CF has one. An empty `wkt` writes the local frame of a site without a CRS.
CfFrame write_crs(hid_t root, const std::string& wkt);

/// Whether two site frames are the same: their projections have equal parameters.
[[nodiscard]] bool is_one_frame(const std::string& a, const std::string& b);

/// The site frame with its place (chain/terrain/site_wkt.h); the local frame if the file gives none. The
/// place of a local frame that version 0.2.0 wrote comes from the configurations of the file's history.
[[nodiscard]] std::string read_crs(const LandfallFileReader& file);

}  // namespace landfall
