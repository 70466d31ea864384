// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D380
#include "files/scan_poses.h"

#include <span>

#include "hdf5/table.h"
#include "returns/columns.h"

namespace landfall {

ScanPoses read_scan_poses(const ScanReader& reader) {
  const LandfallFileReader& scan = reader.file();
  const TableReader pulses(scan.root(), "pulses", scan.name());
  PulseColumns p;
  p.t = reader.pulse_times_s();
  const std::size_t count = p.t.size();
  for (const auto member :
       {&PulseColumns::px_est, &PulseColumns::py_est, &PulseColumns::pz_est, &PulseColumns::qw_est,
        &PulseColumns::qx_est, &PulseColumns::qy_est, &PulseColumns::qz_est}) {
    if (pulses.row_count(name_of(member)) != count)
      scan.fail("columns /pulses/t and /pulses/" + std::string(name_of(member)) + " differ in length");
    (p.*member).resize(count);
    pulses.read(name_of(member), 0, std::span(p.*member));
  }
  return estimated_poses(scan.name(), p);
}

}  // namespace landfall
