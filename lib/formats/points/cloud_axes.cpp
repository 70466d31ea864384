// SPDX-License-Identifier: GPL-3.0-or-later
#include "formats/points/cloud_axes.h"

#include <utility>

namespace landfall {

void rotate(const CloudAxes& axes, CloudBatch& batch) {
  if (axes.y_up) {
    std::swap(batch.columns[1], batch.columns[2]);
    for (double& y : batch.columns[1]) y = -y;
  }
  if (axes.latitude_first) std::swap(batch.columns[0], batch.columns[1]);
}

void rotate(const CloudAxes& axes, CloudInfo& info) {
  const auto swap_axes = [&](std::size_t a, std::size_t b) {
    std::swap(info.is_float32[a], info.is_float32[b]);
    if (info.steps) {
      std::swap(info.steps->scale[a], info.steps->scale[b]);
      std::swap(info.steps->offset[a], info.steps->offset[b]);
    }
    if (info.box) {
      std::swap(info.box->low[a], info.box->low[b]);
      std::swap(info.box->high[a], info.box->high[b]);
    }
  };
  if (axes.y_up) {
    swap_axes(1, 2);
    if (info.steps) info.steps->offset[1] = -info.steps->offset[1];
    if (info.box) {
      std::swap(info.box->low[1], info.box->high[1]);
      info.box->low[1] = -info.box->low[1];
      info.box->high[1] = -info.box->high[1];
    }
  }
  if (axes.latitude_first) swap_axes(0, 1);
}

}  // namespace landfall
