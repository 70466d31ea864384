// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/runs/selected_cloud.h"
#include "base/core/progress.h"
#include "formats/points/cloud_times.h"
#include "formats/points/screened_cloud.h"
#include "store/files/landfall_file.h"

namespace landfall {

/// A file of points to import, and the options that say how.
struct CloudImport {
  std::string path;
  std::vector<double> center{};  ///< E, N or E, N, H, in the units of the points; empty: from their extent
  std::string crs{};             ///< a definition; empty: that of the file
  std::string columns{};         ///< --columns
  std::optional<double> vertical_scale{};
  CloudSelection selection{};
  CloudAxes axes{};
  bool up_is_given = false;  ///< no warning of points that seem to stand on edge
  std::optional<TimeUnit> time_unit{};
  CloudNodata nodata{};  ///< --nodata
};

/// An output and its inputs; the provenance without configuration and inputs, which are added.
struct ImportOutput {
  OutputOptions file;
  Provenance provenance;
  PhaseRunner phase;
};

struct ImportedCloud {
  std::int64_t point_count = 0;
  std::array<double, 3> center{};
  std::array<std::array<double, 2>, 3> bounds_m{};  ///< in the site frame: low, high
  std::string format, crs_name;
  LeftOut left_out;
  std::vector<std::string> warnings{};
};

/// Writes the points of a file as a scan.h5 in the site frame: x_est = (E - center) metres per unit and so
/// on, H minus the centre's H, which is 0 unless given. Points that are not finite, and those that are not
/// selected, are left out with a warning; noise that is kept has the status of a false return. Reads the file
/// twice, in bounded memory, so that nothing is written for one that is not complete. Throws as SelectedCloud
/// and point_frame() do; FormatError for a file of which no point is left, for points outside the box that
/// the file declares (compare_with_box()), and for a pulse, pixel or number of a return that is not an
/// integer in its range.
ImportedCloud import_cloud(const CloudImport& import, ImportOutput output);

}  // namespace landfall
