// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/table.h"

namespace landfall {

/// The description of a layer or a column.
struct ContentInfo {
  std::string name;
  h5::Type type;  ///< the smallest of ours that holds every stored value
  std::string units;
  std::string long_name;
};

/// Whether the values are flags, classes or numbers of things, of which no mean makes sense.
[[nodiscard]] bool is_class(const ContentInfo& content);

/// The name with its unit appended as in this project's names: x_est_m, t_s, count. The unit is omitted if it
/// is missing or not a word, or if the name already ends with it.
[[nodiscard]] std::string name_with_unit(const ContentInfo& content);

/// The kind of a landfall file: terrain, scan, dem, evaluation, plan, hazards or draws.
[[nodiscard]] std::string kind_of(const LandfallFileReader& file);

/// True if the file has a grid: coordinates /x and /y.
[[nodiscard]] bool has_grid(const LandfallFileReader& file);

/// The layers of a grid: the numeric datasets at the root of the shape (y, x), in the order in which the
/// tools write them, then those that no tool knows by name. Layers whose names contain other characters than
/// letters, digits and _ are left out; control characters in texts become spaces.
[[nodiscard]] std::vector<ContentInfo> layers_of(const LandfallFileReader& file, const GridSpec& spec);

/// The columns of a scan's points: the one-dimensional numeric datasets, in the order of kPointColumns, then
/// the others.
[[nodiscard]] std::vector<ContentInfo> columns_of(const TableReader& points);

/// The columns of a hazard map's sites, in the order of sites.json, then the others.
[[nodiscard]] std::vector<ContentInfo> site_columns_of(const TableReader& sites);

}  // namespace landfall
