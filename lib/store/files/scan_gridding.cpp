// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D380
#include "store/files/scan_gridding.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/memory/available_memory.h"
#include "base/raster/grid_spec.h"
#include "base/returns/columns.h"
#include "chain/gridding/weighted_mean_accumulator.h"
#include "store/hdf5/table.h"

// A terrain that was not scanned is refused as truth unless `--same-frame` is given, because its z_true
// would be that of another site.

namespace landfall {
namespace {

struct Batch {
  ScanReader* scan;
  std::size_t number;  ///< of the scan
  std::size_t begin;
  std::size_t count;
};

std::vector<Batch> batches(const Scans& scans) {
  std::vector<Batch> result;
  for (std::size_t i = 0; i < scans.size(); ++i)
    for (std::size_t begin = 0; begin < scans[i]->row_count(); begin += kBatchRows)
      result.push_back({scans[i].get(), i, begin, std::min(kBatchRows, scans[i]->row_count() - begin)});
  return result;
}

/// The bins that returns can fall on, by the pages of memory that they make the system provide.
void require_bins_fit(const Scans& scans, const GriddingRequest& request) {
  constexpr std::uint64_t kBytesPerBin = sizeof(BinSums);
  constexpr std::uint64_t kBytesPerReturn = 4096;  // a page, if each falls on its own
  std::uint64_t returns = 0;
  for (const auto& scan : scans) returns += scan->row_count();
  require_memory(std::min(kBytesPerBin * request.grid.size(), kBytesPerReturn * returns),
                 "gridding " + size_text(request.grid), "choose a smaller half_width_m or larger bins");
}

GriddedScans empty_bins(const GriddingRequest& request) {
  GriddedScans gridded;
  if (request.method == Method::bilinear_nearest) {
    auto nearest = std::make_unique<WeightedMeanAccumulator>(request.grid);
    gridded.nearest = nearest.get();
    gridded.bins = std::move(nearest);
  } else {
    gridded.bins = make_accumulator(request.method, request.grid);
  }
  assert(!request.moments || gridded.nearest != nullptr);
  if (request.moments) gridded.moments.emplace(request.grid);
  return gridded;
}

EdgeSample sample_edges(const GridPoints& points, double resolution_m) {
  constexpr double kTolerance = 1e-9;  // bins
  const auto on_edge = [&](double coordinate_m) {
    const double bin = coordinate_m / resolution_m + 0.5;
    return std::abs(bin - std::nearbyint(bin)) <= kTolerance;
  };
  EdgeSample sample{static_cast<std::int64_t>(std::min(points.size(), kTableChunkRows))};
  for (std::size_t i = 0; i < static_cast<std::size_t>(sample.count); ++i)
    sample.on_edge += on_edge(points.x_est[i]) || on_edge(points.y_est[i]) ? 1 : 0;
  return sample;
}

/// Removes returns without a position; returns their number.
std::int64_t drop_unplaced(ScanPoints& points) {
  std::size_t next = 0;
  const std::size_t count = points.t.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(points.columns.x_est[i]) || std::isnan(points.columns.x_true[i])) continue;
    points.t[next] = points.t[i];
    for (const auto member : kCoordinates) (points.columns.*member)[next] = (points.columns.*member)[i];
    ++next;
  }
  points.t.resize(next);
  for (const auto member : kCoordinates) (points.columns.*member).resize(next);
  return static_cast<std::int64_t>(count - next);
}

/// Brings a batch to the frame of the first scan; returns how many of its returns have no place there.
std::int64_t place_batch(const Placement& placement, ScanPoints& points) {
  if (placement.is_identity()) return 0;
  placement.to_first(points.columns.x_est, points.columns.y_est);
  placement.to_first(points.columns.x_true, points.columns.y_true);
  placement.raise(points.columns.z_est);
  return placement.is_reprojected() ? drop_unplaced(points) : 0;
}

/// Grids a batch while the next one is read.
void grid_pass(const std::vector<Batch>& todo, const GriddingRequest& request, GriddedScans& gridded,
               const ProgressCallback& progress) {
  gridded.without_place = 0;
  std::array<ScanPoints, 2> slots;
  read_ahead(
      todo.size(), slots.size(),
      [&](std::size_t i, std::size_t slot) {
        todo[i].scan->read(todo[i].begin, todo[i].count, slots[slot]);
        if (!request.placements.empty())
          gridded.without_place += place_batch(request.placements[todo[i].number], slots[slot]);
      },
      [&](std::size_t i, std::size_t slot) {
        const GridPoints points = slots[slot].view();
        gridded.bins->add(points);
        if (todo[i].begin == 0)
          gridded.edges[todo[i].number] = sample_edges(points, request.grid.resolution_m);
        if (gridded.moments) gridded.moments->add(points, *gridded.nearest);
        report(progress,
               gridded.bins->progress(static_cast<double>(i + 1) / static_cast<double>(todo.size())));
      });
}

/// The id of the terrain that a scan's history names; empty if it names none.
std::string terrain_id_of(const ScanReader& scan) {
  for (const nlohmann::json& step : scan.file().chain())
    if (step.value("tool", "") == "terrain-gen") return step.value("file_id", "");
  return "";
}

/// Twice in one map, a return would count twice in the error of its bin.
void require_distinct(const Scans& scans) {
  std::map<std::string, std::string> names;  // by file_id
  for (const auto& scan : scans) {
    const LandfallFileReader& file = scan->file();
    if (const auto [first, is_new] = names.emplace(file.file_id(), file.name()); !is_new)
      throw FormatError(file.name() + ": is the same scan as " + first->second);
  }
}

}  // namespace

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

Scans open_scans(const std::vector<std::string>& paths, Provenance& provenance) {
  Scans scans;
  for (const std::string& path : paths) {
    const LandfallFileReader& file = scans.emplace_back(std::make_unique<ScanReader>(path))->file();
    provenance.add_input("scan", file.file_id(), file.chain());
  }
  double epoch_s = std::numeric_limits<double>::infinity();
  for (const auto& scan : scans) epoch_s = std::min(epoch_s, scan->epoch_s());
  for (const auto& scan : scans) scan->count_from(epoch_s);
  return scans;
}

ScanPlacements place_scans(const Scans& scans, const MeetingRules& rules) {
  require_distinct(scans);
  ScanPlacements placements;
  for (const auto& scan : scans) {
    Meeting meeting = meet(meeting_kind("scans"), sited(*scans.front()), sited(*scan), rules);
    add_said(placements.said, scan->file().name(), meeting);
    placements.of.push_back(std::move(meeting.placement));
  }
  return placements;
}

void require_scans_of(const Scans& scans, const TerrainIdentity& terrain, const std::string& terrain_path) {
  for (const auto& scan : scans) {
    if (const std::string scanned = terrain_id_of(*scan); !scanned.empty() && scanned != terrain.file_id)
      throw FormatError(scan->file().name() + ": is a scan of another terrain than " + terrain_path +
                        "; give the scanned one, or --same-frame");
  }
}

GriddedScans grid_scans(const Scans& scans, const GriddingRequest& request,
                        const ProgressCallback& progress) {
  require_bins_fit(scans, request);
  GriddedScans gridded = empty_bins(request);
  const std::vector<Batch> todo = batches(scans);
  gridded.edges.resize(scans.size());
  do grid_pass(todo, request, gridded, progress);
  while (gridded.bins->end_pass());
  return gridded;
}

}  // namespace landfall
