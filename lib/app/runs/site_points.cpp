// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/site_points.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "app/runs/selected_cloud.h"
#include "base/core/error.h"
#include "base/core/parallel.h"
#include "base/text/number_text.h"

namespace landfall {
namespace {

constexpr std::size_t kPointsPerPiece = 1U << 14U;

/// Keeps the values of a column at these places.
template <class T>
void keep(std::vector<T>& column, const std::vector<char>& is_kept) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < column.size(); ++i)
    if (is_kept[i] != 0) column[kept++] = column[i];
  column.resize(kept);
}

}  // namespace

std::int64_t SitePoints::convert(CloudBatch& batch, ImportedPoints& points) const {
  const std::size_t count = batch.size();
  PointColumns& columns = points.columns;
  columns.x_est.resize(count);
  columns.y_est.resize(count);
  columns.z_est.resize(count);
  columns.status.resize(count);
  std::vector<char> is_placed(count);
  parallel_for(count, frame_.one_thread ? std::max<std::size_t>(count, 1) : kPointsPerPiece,
               [&](std::size_t begin, std::size_t end) {
                 for (std::size_t i = begin; i < end; ++i) is_placed[i] = place(batch, i, columns) ? 1 : 0;
               });
  const std::int64_t beyond = std::ranges::count(is_placed, 0);
  if (beyond > 0) {
    batch.keep_if([&](std::size_t i) { return is_placed[i] != 0; });
    for (auto* column : {&columns.x_est, &columns.y_est, &columns.z_est}) keep(*column, is_placed);
    keep(columns.status, is_placed);
  }
  require_places(batch, columns);
  integers(batch, CloudField::pulse, columns.pulse);
  integers(batch, CloudField::pixel, columns.pixel);
  integers(batch, CloudField::return_number, columns.return_number);
  require_finite(batch, CloudField::intensity);
  const std::vector<double>& intensity = batch[CloudField::intensity];
  columns.intensity.assign(intensity.begin(), intensity.end());
  columns.echo_width = batch[CloudField::echo_width];
  require_finite(batch, CloudField::t);
  points.t.clear();
  for (const double t : batch[CloudField::t]) points.t.push_back(times_.seconds(t));
  return beyond;
}

/// False for a point beyond the horizon of the site.
bool SitePoints::place(const CloudBatch& batch, std::size_t i, PointColumns& points) const {
  const MapPoint p{batch.columns[0][i], batch.columns[1][i]};
  std::optional<SitePoint> at = SitePoint{(p.x - frame_.center.x) * frame_.metres_per_unit,
                                          (p.y - frame_.center.y) * frame_.metres_per_unit};
  if (frame_.site) at = frame_.site(p);
  if (!at) return false;
  points.x_est[i] = at->x_m;
  points.y_est[i] = at->y_m;
  points.z_est[i] = (batch.columns[2][i] - center_height_) * frame_.metres_per_height;
  const std::vector<double>& classes = batch[CloudField::classification];
  points.status[i] =
      !classes.empty() && is_noise(classes[i]) ? PointStatus::false_return : PointStatus::returned;
  return true;
}

void SitePoints::require_places(const CloudBatch& batch, const PointColumns& points) const {
  for (std::size_t i = 0; i < batch.size(); ++i)
    if (!std::isfinite(points.x_est[i]) || !std::isfinite(points.y_est[i]))
      throw FormatError(name_ + ": the point at " + number_text(batch.columns[0][i]) + ", " +
                        number_text(batch.columns[1][i]) + " lies outside its map projection");
}

void SitePoints::require_finite(const CloudBatch& batch, CloudField field) const {
  for (const double value : batch[field])
    if (!std::isfinite(value))
      throw FormatError(name_ + ": its column " + name_of(field) + " holds " + number_text(value) +
                        ", which is not finite: remove those points");
}

template <class T>
void SitePoints::integers(const CloudBatch& batch, CloudField field, std::vector<T>& out) const {
  const std::vector<double>& values = batch[field];
  out.resize(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= 0 && values[i] <= static_cast<double>(std::numeric_limits<T>::max()) &&
          values[i] == std::floor(values[i])))
      throw FormatError(name_ + ": a " + name_of(field) + " of " + number_text(values[i]) +
                        " is not an integer in [0, " + std::to_string(std::numeric_limits<T>::max()) + "]");
    out[i] = static_cast<T>(values[i]);
  }
}

}  // namespace landfall
