// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "base/output/byte_sink.h"
#include "base/output/output_path.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// Writes the landing sites of a hazard map as comma-separated text: a header, then a line per site, the best
/// first. Throws FormatError if the file has no sites.
void write_sites_csv(const LandfallFileReader& hazards, ByteSink& sink);

/// Writes them as the points (x, y, z) of the layer `sites` of a GeoPackage, in the file's frame, with their
/// other columns as attributes (gdal_loader.h).
void write_sites_geopackage(const LandfallFileReader& hazards, const OutputOptions& output);

}  // namespace landfall
