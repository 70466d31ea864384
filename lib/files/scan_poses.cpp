// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/scan_poses.h"

#include <array>
#include <span>

#include "hdf5/table.h"

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
  ScanPoses poses{scan.name(), read_thinned(pulses, "t"), {}, {}};
  std::array<std::vector<double>, 7> columns;
  constexpr std::array<const char*, 7> kNames = {"px_est", "py_est", "pz_est", "qw_est",
                                                 "qx_est", "qy_est", "qz_est"};
  for (std::size_t c = 0; c < columns.size(); ++c) {
    columns[c] = read_thinned(pulses, kNames[c]);
    if (columns[c].size() != poses.t_s.size())
      scan.fail("columns /pulses/t and /pulses/" + std::string(kNames[c]) + " differ in length");
  }
  for (std::size_t i = 0; i < poses.t_s.size(); ++i) {
    poses.position_m.emplace_back(columns[0][i], columns[1][i], columns[2][i]);
    poses.attitude.emplace_back(columns[3][i], columns[4][i], columns[5][i], columns[6][i]);
  }
  return poses;
}

}  // namespace landfall
