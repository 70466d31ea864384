// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <landfall/lidar.h>

#include <map>
#include <string>
#include <vector>

#include "heightfield.h"

namespace lander {

/// Reads a terrain.h5 that holds a grid.
[[nodiscard]] Heightfield read_terrain(const std::string& path);

/// The returns and poses of a scan, in the layout that regrid reads (docs/user/files/scan.md).
class ScanFile {
 public:
  void add(double t_s, const landfall::lidar::Pulse& pulse, const landfall::lidar::PulseReturns& returns);
  void write(const std::string& path) const;
  [[nodiscard]] std::size_t return_count() const { return pulse_.size(); }

 private:
  std::map<std::string, std::vector<double>> pulses_, points_;
  std::vector<int> pulse_, pixel_;
  std::vector<signed char> status_;
};

}  // namespace lander
