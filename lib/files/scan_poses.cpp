// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/scan_poses.h"

#include <span>

#include "hdf5/table.h"
#include "returns/columns.h"

namespace landfall {
namespace {

constexpr std::size_t kMaxSteps = 16384;

std::vector<double> read_thinned(const TableReader& pulses, const char* column) {
  std::vector<double> all(pulses.row_count(column));
  pulses.read(column, 0, std::span(all));
  const std::size_t stride = (all.size() + kMaxSteps - 1) / kMaxSteps;
  std::vector<double> kept;
  for (std::size_t i = 0; i < all.size(); i += stride) kept.push_back(all[i]);
  if (!all.empty() && (all.size() - 1) % stride != 0) kept.push_back(all.back());
  return kept;
}

}  // namespace

ScanPoses read_scan_poses(const LandfallFileReader& scan) {
  const TableReader pulses(scan.root(), "pulses", scan.name());
  ScanPoses poses{scan.name(), read_thinned(pulses, name_of(&PulseColumns::t)), {}, {}};
  PulseColumns p;
  for (const auto member :
       {&PulseColumns::px_est, &PulseColumns::py_est, &PulseColumns::pz_est, &PulseColumns::qw_est,
        &PulseColumns::qx_est, &PulseColumns::qy_est, &PulseColumns::qz_est}) {
    p.*member = read_thinned(pulses, name_of(member));
    if ((p.*member).size() != poses.t_s.size())
      scan.fail("columns /pulses/t and /pulses/" + std::string(name_of(member)) + " differ in length");
  }
  for (std::size_t i = 0; i < poses.t_s.size(); ++i) {
    poses.position_m.emplace_back(p.px_est[i], p.py_est[i], p.pz_est[i]);
    poses.attitude.emplace_back(p.qw_est[i], p.qx_est[i], p.qy_est[i], p.qz_est[i]);
  }
  return poses;
}

}  // namespace landfall
