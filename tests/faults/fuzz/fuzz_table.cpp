// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of numbers, as the configurations of scan-sim name them.
//
// An input is a letter (t: trajectory, s: scanner angles, p: pattern, d: pixels of a detector) and the file:
// CSV, or HDF5 by its signature.
#include <cmath>

#include "chain/lidar/detector/perspective.h"
#include "chain/lidar/scanner/patterns.h"
#include "chain/lidar/scanner/table_scanner.h"
#include "chain/lidar/trajectory/table_trajectory.h"
#include "fuzz_target.h"
#include "memory_file.h"
#include "store/files/table_reader.h"

namespace landfall::fuzz {
namespace {

/// Between, at and around the rows; only times within the table have a pose.
void use(const TableTrajectory& trajectory) {
  const double last = trajectory.end_time_s();
  for (const double part : {0.0, 0.3, 0.5, 0.999, 1.0}) {
    if (!trajectory.pose(std::min(last, last * part)).rotation.m.allFinite())
      throw BrokenPromise("a trajectory whose attitude is not finite");
  }
}

void use_trajectory(const std::filesystem::path& file) {
  const NumberTable table = read_number_table(file, trajectory_columns());
  use(TableTrajectory(trajectory_samples(table), table.file() + ": trajectory table"));
}

void use_angles(const std::filesystem::path& file) {
  const NumberTable table = read_number_table(file, angle_columns());
  for (const std::optional<TableMirror>& mirror :
       {std::optional<TableMirror>(), std::optional(TableMirror{0.5, 0})}) {
    const TableScanner scanner(angle_samples(table), mirror, table.file() + ": scanner table");
    for (const double t : {0.0, 0.1, 1.0})
      static_cast<void>(scanner.state(PulseContext{.time = {.pulse = 0, .since_start_s = t}}));
  }
}

void use_aims(const std::filesystem::path& file) {
  const NumberTable table = read_number_table(file, aim_columns());
  for (const AtTableEnd at_end : {AtTableEnd::stop, AtTableEnd::hold, AtTableEnd::wrap}) {
    const TablePattern pattern({aim_samples(table), at_end}, table.file() + ": pattern table");
    for (const double t : {0.0, 0.1, 1e3})
      static_cast<void>(pattern.aim_point({.pulse = 0, .since_start_s = t}));
  }
}

void use_pixels(const std::filesystem::path& file) {
  PerspectiveParameters detector{.rows = 2, .columns = 3, .subpixels = 2};
  detector.distortion = {0.1, 0.01, 0};
  detector.points =
      pixel_points(read_number_table(file, pixel_table_columns()), detector.rows, detector.columns);
  // Whether the lens folds the image is a matter of the configuration, which the message then names.
  static_cast<void>(accepts("detector", [&] { static_cast<void>(perspective_detector(detector)); }));
}

void use(std::uint8_t role, const std::filesystem::path& file) {
  switch (role) {
    case 's':
      return use_angles(file);
    case 'p':
      return use_aims(file);
    case 'd':
      return use_pixels(file);
    default:
      return use_trajectory(file);
  }
}

}  // namespace
}  // namespace landfall::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace landfall::fuzz;
  static MemoryFile file;
  InputBytes input({data, size});
  const std::uint8_t role = input.byte();
  const std::string bytes = input.rest();
  file.fill(std::as_bytes(std::span(bytes)));
  static_cast<void>(accepts(file.path().string(), [&] { use(role, file.path()); }));
  return 0;
}
