// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/cloud_output.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/exports/point_reader.h"
#include "app/exports/point_thinning.h"
#include "app/report/cloud_page.h"
#include "base/returns/columns.h"

namespace landfall {
namespace {

constexpr const char* kPulseTime = name_of(&PulseColumns::t);
constexpr const char* kPageColumns[] = {
    name_of(&PointColumns::x_true),         name_of(&PointColumns::y_true),
    name_of(&PointColumns::z_true),         name_of(&PointColumns::range_true),
    name_of(&PointColumns::range_measured), kPulseTime,
    name_of(&PointColumns::status),         name_of(&PointColumns::intensity),
    name_of(&PointColumns::return_number),  name_of(&PointColumns::pulse),
    name_of(&PointColumns::pixel)};

PointPlace place_of(const PointBatch& batch, std::uint32_t row) {
  return {batch.real(0)[row], batch.real(1)[row]};
}

/// The extent of the returns, and places of some of them.
struct ReturnExtent {
  std::uint64_t count = 0;
  PointPlace low{};
  PointPlace high{};
  std::vector<PointPlace> sample;
};

ReturnExtent return_extent_of(const PointReader& points, const PointReader::Pass& pass,
                              const ProgressCallback& progress) {
  constexpr std::size_t kSample = 65536;
  const std::size_t stride = points.row_count() / kSample + 1;
  ReturnExtent extent;
  points.read(
      pass,
      [&](const PointBatch& batch) {
        for (const std::uint32_t row : batch.selected) {
          const PointPlace place = place_of(batch, row);
          if (extent.count == 0) extent.low = extent.high = place;
          for (std::size_t axis = 0; axis < 2; ++axis) {
            extent.low[axis] = std::min(extent.low[axis], place[axis]);
            extent.high[axis] = std::max(extent.high[axis], place[axis]);
          }
          if (extent.count++ % stride == 0) extent.sample.push_back(place);
        }
      },
      progress);
  return extent;
}

/// About the edge of the squares in which `points` points lie alone, if the outer tenth is left out.
double first_cell_m(ReturnExtent& extent, std::size_t points) {
  double area_m2 = 1;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::ranges::sort(extent.sample, {}, [axis](const PointPlace& place) { return place[axis]; });
    const std::size_t outer = extent.sample.size() / 20;
    area_m2 *= extent.sample[extent.sample.size() - 1 - outer][axis] - extent.sample[outer][axis];
  }
  return std::sqrt(area_m2 / static_cast<double>(points));
}

ThinnedPoints choose_points(const PointReader& points, const PointReader::Pass& pass, ReturnExtent& extent,
                            std::size_t max_points, const ProgressCallback& progress) {
  constexpr std::size_t kFiner = 8;  // squares for each point of the page
  PointThinning thinning(extent.low, extent.high, first_cell_m(extent, kFiner * max_points), max_points);
  points.read(
      pass,
      [&](const PointBatch& batch) {
        for (const std::uint32_t row : batch.selected)
          thinning.add(place_of(batch, row), batch.first_row + row);
      },
      progress);
  return thinning.finish();
}

/// Counts from the earliest point.
void from_zero(std::vector<double>& times_s) {
  double first_s = std::numeric_limits<double>::infinity();
  for (const double time_s : times_s)
    if (time_s < first_s) first_s = time_s;
  for (double& time_s : times_s) time_s -= first_s;
}

html_report::CloudContent read_cloud(const PointReader& points, std::size_t max_points,
                                     const ProgressCallback& progress) {
  PointReader::Pass pass{position_columns("est"), {}, 3};
  ReturnExtent extent = return_extent_of(points, pass, [&](double f) { report(progress, f / 5); });
  if (extent.count == 0) points.file().fail("holds no return");
  html_report::CloudContent content;
  content.all_count = extent.count;
  std::vector<std::uint64_t> rows;
  if (extent.count > max_points) {
    ThinnedPoints thinned =
        choose_points(points, pass, extent, max_points, [&](double f) { report(progress, (1 + f) / 5); });
    content.cell_m = thinned.cell_m;
    rows = std::move(thinned.rows);
  }
  for (const char* const name : kPageColumns)
    if (points.has(name)) pass.columns.emplace_back(name);
  content.has_pulses = !points.pulse_times().since_s.empty();
  if (content.has_pulses) pass.first_time_s = 0;
  std::size_t next = 0;
  points.read(
      pass,
      [&](const PointBatch& batch) {
        for (const std::uint32_t row : batch.selected) {
          if (content.cell_m > 0 && (next == rows.size() || rows[next] != batch.first_row + row)) continue;
          ++next;
          for (std::size_t c = 0; c < pass.columns.size(); ++c)
            content.columns[pass.columns[c]].push_back(batch.number(c, row));
        }
      },
      [&](double f) { report(progress, (2 + f) / 5); });
  if (!content.has_pulses && points.has(kPulseTime)) from_zero(content.columns.at(kPulseTime));
  return content;
}

}  // namespace

void write_cloud_page(const std::string& scan, const OutputOptions& output, std::size_t max_points,
                      const ProgressCallback& progress) {
  const PointReader points(scan);
  const html_report::CloudContent content = read_cloud(points, max_points, progress);
  OutputPath path(output.path, output.overwrite);
  write_text(path, html_report::cloud_page(content, points.file().chain()));
  path.commit();
  report(progress, 1);
}

}  // namespace landfall
