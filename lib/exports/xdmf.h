// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "io/contents.h"

namespace landfall {

/// Where an XDMF file finds its data: the name of the .h5 as seen from the folder of `xdmf`; relative where
/// both are in or below one folder, else absolute.
[[nodiscard]] std::string xdmf_reference(const std::filesystem::path& data,
                                         const std::filesystem::path& xdmf);

/// XDMF 3 over the columns of /points: x, y and z of `position` ("est" or "true") are the places, every
/// column is an attribute.
[[nodiscard]] std::string points_xdmf(const std::vector<ContentInfo>& columns, std::size_t rows,
                                      const std::string& position, const std::string& reference);

/// XDMF 3 over a grid: an image of one layer of cells in z, its nodes the bin centres, every layer an
/// attribute.
[[nodiscard]] std::string grid_xdmf(const std::vector<ContentInfo>& layers, const GridSpec& spec,
                                    const std::string& reference);

}  // namespace landfall
