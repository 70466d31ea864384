// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/text/number_table.h"
#include "chain/lidar/scanner/mechanism.h"
#include "chain/lidar/scanner/mirror_frame.h"
#include "chain/lidar/scanner/scanner.h"

namespace landfall {

/// One row of a table of angles.
struct AngleSample {
  double t_s = 0;  ///< since the first pulse
  TiltAngles angles{};
};

/// The columns of a table of angles: t_s, angle_1_rad, angle_2_rad.
[[nodiscard]] TableColumns angle_columns();
/// The rows of a table with these columns.
[[nodiscard]] std::vector<AngleSample> angle_samples(const NumberTable& table);

/// The mirror whose tilts a table contains.
struct TableMirror {
  double incidence_rad = 0;
  double fold_azimuth_rad = 0;
};

/// Replays tabulated angles, linear in time between the rows: the tilts of an Fsm that turns about its
/// surface or, without a mirror, those of a Gimbal, which turns the camera. Times count from the first pulse,
/// so that a table fits any trajectory. Pulse times are rounded, so a time up to 1 ns outside the table
/// counts as its end.
class TableScanner : public Scanner {
 public:
  /// At least two rows, all finite, with strictly increasing times. Otherwise throws FormatError, beginning
  /// with `name`, with the row counted from 1; UsageError for a mirror parameter out of range.
  TableScanner(std::vector<AngleSample> samples, const std::optional<TableMirror>& mirror,
               std::string name = "scanner table");

  /// Throws FormatError, naming the pulse, for a time outside the table and where the boresight would meet
  /// the back of the mirror.
  [[nodiscard]] ScannerState state(const PulseContext& pulse) const override;
  void steer(const ScannerState& state, std::span<const Direction<LidarFrame>> pixels,
             std::span<Beam> beams) const override;

 private:
  [[nodiscard]] TiltAngles angles(const PulseTime& pulse) const;
  [[noreturn]] void refuse(const PulseTime& pulse, const std::string& what) const;

  std::vector<AngleSample> samples_;
  std::string name_;
  std::optional<MirrorFrame> mirror_;  // empty for a gimbal
};

}  // namespace landfall
