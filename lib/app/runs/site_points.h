// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "formats/gdal/point_frame.h"
#include "formats/points/cloud_reader.h"
#include "formats/points/cloud_times.h"
#include "store/files/imported_scan.h"

namespace landfall {

/// Converts points of a file to the site frame, and their times to seconds. Noise becomes false returns.
class SitePoints {
 public:
  /// Keeps references to the frame and to the name of the file, which begins messages.
  SitePoints(const PointFrame& frame, double center_height, TimeScale times, const std::string& name)
      : frame_(frame), center_height_(center_height), times_(std::move(times)), name_(name) {}

  /// Removes points beyond the horizon of the site from the batch; returns their number. Throws FormatError
  /// for a point that lies outside its map projection, for an intensity or a time that is not finite, and for
  /// a pulse, pixel or number of a return that is not an integer in its range.
  std::int64_t convert(CloudBatch& batch, ImportedPoints& points) const;

 private:
  [[nodiscard]] bool place(const CloudBatch& batch, std::size_t i, PointColumns& points) const;
  void require_places(const CloudBatch& batch, const PointColumns& points) const;
  void require_finite(const CloudBatch& batch, CloudField field) const;
  template <class T>
  void integers(const CloudBatch& batch, CloudField field, std::vector<T>& out) const;

  const PointFrame& frame_;
  double center_height_;
  TimeScale times_;
  const std::string& name_;
};

}  // namespace landfall
