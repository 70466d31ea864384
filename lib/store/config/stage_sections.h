// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "store/config/json_source.h"

namespace landfall {

/// The sections of a configuration that holds those of several stages, of the schema chain or draws, and the
/// schema of each, which has the section's name: terrain, scan, regrid, eval, hazard.
[[nodiscard]] const std::vector<std::string>& stage_sections(const std::string& schema);

/// A stage's section of the configuration `name`, as its tool's own; messages know the keys of an import too.
[[nodiscard]] JsonSource stage_source(const std::string& stage, const nlohmann::json& section,
                                      const std::string& name);

/// Whether configurations of this schema have such sections: chain and draws.
[[nodiscard]] bool has_stage_sections(const std::string& schema);

/// Replaces each section that is "preset:NAME", the name of a file in `folder`, or a list of these and of
/// objects, by the object that they give when they are merged in order (RFC 7396). /terrain/from is joined to
/// the folder of the file that it is read from; absolute paths and GDAL's names (NETCDF:"f.h5":z) stay.
/// Throws UsageError for an unknown preset or file; other values are left for the schema to refuse.
void expand_stage_sections(JsonSource& source, const std::filesystem::path& folder = {});

/// Fills in what /area gives and a section leaves out (docs/user/landfall.md): half_width_m and resolution_m
/// of /regrid and, 10 m wider, rounded up to its nodes and with a spacing of at most max(0.1 m,
/// footprint/17), of /terrain/grid; region, and the region_radius_m (half_width_m if it is not given) of a
/// circle, of /eval and of /hazard. Missing sections of regrid and eval are made, the others only if
/// `makes_all`. A mesh has no grid. Values of another type than the schema's are left for it to refuse.
void fill_area(nlohmann::json& config, bool makes_all);

/// Whether /terrain of a configuration with stage sections names a raster or mesh.
[[nodiscard]] bool is_import(const nlohmann::json& config);

/// The half width of a terrain under a map of this half width.
[[nodiscard]] double terrain_half_width(double half_width_m, double resolution_m);

}  // namespace landfall
