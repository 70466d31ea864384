// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/returns/columns.h"
#include "store/files/landfall_file.h"
#include "store/hdf5/table.h"

namespace landfall {

/// The columns of imported points, besides x_est, y_est, z_est and status.
struct ImportedColumns {
  std::vector<std::string> of_points{};  ///< by their names in /points
  bool t = false;
  std::string clock{};  ///< what t counts; empty: not known
};

/// Points that landfall did not make, in the site frame, metres; the columns that exist.
struct ImportedPoints {
  PointColumns columns;
  std::vector<double> t;  ///< seconds, on the clock of the source
};

/// The source of the points: attributes of /points.
struct ImportedOrigin {
  std::array<double, 3> center{};  ///< the site's origin, in the units of the source
  std::string format;
  double first_t_s = 0;  ///< the least t
};

/// Writes a scan.h5 of points without lidar: /points without truth, no /pulses (docs/user/files/scan.md).
class ImportedScanWriter {
 public:
  ImportedScanWriter(LandfallFileWriter& file, ImportedColumns columns, const std::string& crs_wkt);
  void append(const ImportedPoints& points);
  /// Writes the counts, and commits.
  void commit(const ImportedOrigin& origin);

 private:
  LandfallFileWriter& file_;
  ImportedColumns columns_;
  TableWriter points_;
  std::int64_t false_returns_ = 0;
};

/// Whether a scan holds points that landfall did not make: it has no /pulses and no true points.
[[nodiscard]] bool is_imported_scan(const LandfallFileReader& scan);

/// The time to which those of an imported scan are relative: the least one; 0 without times.
[[nodiscard]] double imported_epoch_s(const LandfallFileReader& scan);

/// The heights of an imported scan's source.
struct SourceHeights {
  double center = 0;  ///< of the scan's origin; 0 where none was given
  double metres_per_unit = 1;
};
[[nodiscard]] SourceHeights source_heights(const LandfallFileReader& scan);

}  // namespace landfall
