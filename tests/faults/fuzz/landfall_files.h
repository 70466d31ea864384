// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "store/files/provenance.h"

namespace landfall::fuzz {

/// A small valid file, as our own tools write it.
struct LandfallFile {
  std::string kind;                  ///< terrain, mesh, scan, dem, evaluation, plan, table, hazards or draws
  std::vector<std::byte> bytes;      ///< unsealed, with few chunks
  std::vector<std::byte> sealed;     ///< as it was written
  std::vector<std::string> objects;  ///< paths of groups and datasets, "/" first
  std::vector<std::pair<std::string, std::string>> attributes;  ///< object and name
};

/// One file of each kind that landfall reads: a grid terrain with features, a mesh terrain, a scan of the
/// first, its DEM with every layer, the evaluation of that, a plan, a trajectory table in HDF5, a hazard
/// map of the first, and two draws.
[[nodiscard]] const std::vector<LandfallFile>& landfall_files();

/// How the scan was made: what --ranges-from compares with.
[[nodiscard]] const Provenance& scan_provenance();

}  // namespace landfall::fuzz
