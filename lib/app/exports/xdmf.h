// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/exports/point_reader.h"
#include "store/files/contents.h"
#include "store/files/point_positions.h"

namespace landfall {

/// The path by which an XDMF file refers to its data: the .h5 as seen from the folder of `xdmf`; relative if
/// both are in or below one folder, else absolute.
[[nodiscard]] std::string xdmf_reference(const std::filesystem::path& data,
                                         const std::filesystem::path& xdmf);

/// The file of the points' positions (store/files/point_positions.h) that belongs to an .xmf: its name plus
/// .h5.
[[nodiscard]] std::filesystem::path xdmf_positions(const std::filesystem::path& xdmf);

/// The positions of a scan's points: its columns x, y and z of `position` ("est" or "true"), float64 unless
/// all of them are float32. `scan` is its xdmf_reference().
[[nodiscard]] PointPositions positions_of(const PointReader& points, const std::string& position,
                                          const std::string& scan);

/// XDMF 3 for the points of a scan: a vertex at each of the positions, which are in `positions_file` next to
/// the .xmf; every column of the scan is an attribute.
[[nodiscard]] std::string points_xdmf(const std::vector<ContentInfo>& columns,
                                      const PointPositions& positions, const std::string& positions_file);

/// XDMF 3 for a grid: an image with one layer of cells in z, its nodes at the bin centres, every layer an
/// attribute.
[[nodiscard]] std::string grid_xdmf(const std::vector<ContentInfo>& layers, const GridSpec& spec,
                                    const std::string& reference);

}  // namespace landfall
