// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/evaluation/dem_layers.h"

#include <string>

#include "base/core/error.h"
#include "base/raster/layer_check.h"

namespace landfall {
namespace {

void check_layer(const char* name, const Grid<double>& layer, const GridSpec& spec) {
  if (layer.spec() != spec) throw FormatError(std::string(name) + ": its grid differs from that of z_est");
  require_values(layer, name, LayerValues::finite);
}

}  // namespace

void check_layers(const DemLayers& dem) {
  const GridSpec& spec = dem.z_est.spec();
  check_layer("z_est", dem.z_est, spec);
  if (dem.corrected) check_layer("z_corrected", *dem.corrected, spec);
  if (dem.count && dem.count->spec() != spec) throw FormatError("count: its grid differs from that of z_est");
  if (!dem.truth) return;
  if (dem.truth->has_positions()) {
    check_layer("x_true", dem.truth->x, spec);
    check_layer("y_true", dem.truth->y, spec);
  }
  check_layer("z_true", dem.truth->z, spec);
}

}  // namespace landfall
