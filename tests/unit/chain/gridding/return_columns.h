// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "chain/gridding/weighted_mean_accumulator.h"

namespace landfall {

/// One return; fields that a test does not set are 0.
struct ReturnPoint {
  double x_est = 0;
  double y_est = 0;
  double z_est = 0;
  double x_true = 0;
  double y_true = 0;
  double z_true = 0;
  double t = 0;
};

/// The columns that GridPoints reads.
struct ReturnColumns {
  std::vector<double> x_est, y_est, z_est, x_true, y_true, z_true, t;

  ReturnColumns() = default;
  explicit ReturnColumns(const std::vector<ReturnPoint>& points) {
    for (const ReturnPoint& p : points) push_back(p);
  }
  void push_back(const ReturnPoint& p) {
    x_est.push_back(p.x_est);
    y_est.push_back(p.y_est);
    z_est.push_back(p.z_est);
    x_true.push_back(p.x_true);
    y_true.push_back(p.y_true);
    z_true.push_back(p.z_true);
    t.push_back(p.t);
  }
  [[nodiscard]] GridPoints view() const { return {x_est, y_est, z_est, x_true, y_true, z_true, t}; }
};

inline WeightedMeanAccumulator accumulated(const GridSpec& spec, const std::vector<ReturnPoint>& points) {
  WeightedMeanAccumulator bins(spec);
  const ReturnColumns columns(points);
  bins.add(columns.view());
  return bins;
}

}  // namespace landfall
