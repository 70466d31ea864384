// SPDX-License-Identifier: GPL-3.0-or-later
#include "evaluation/dem_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "evaluation/piecewise.h"

namespace landfall {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

void check_layer(const char* name, const Grid<double>& layer, const GridSpec& spec) {
  if (layer.spec() != spec) throw FormatError(std::string(name) + ": its grid differs from that of z_est");
  const auto first_infinite = [&](std::size_t begin, std::size_t end) {
    const auto values = layer.values().subspan(begin, end - begin);
    const auto found = std::ranges::find_if(values, [](double v) { return std::isinf(v); });
    return found == values.end() ? kNone : begin + static_cast<std::size_t>(found - values.begin());
  };
  const std::vector<std::size_t> pieces = by_piece(spec.size(), first_infinite);
  const std::size_t index = *std::ranges::min_element(pieces);
  if (index == kNone) return;
  const auto cols = static_cast<std::size_t>(spec.cols);
  throw FormatError(std::string(name) + ": the value in row " + std::to_string(index / cols) + ", column " +
                    std::to_string(index % cols) + " is infinite");
}

}  // namespace

void check_layers(const DemLayers& dem) {
  const GridSpec& spec = dem.z_est.spec();
  check_layer("z_est", dem.z_est, spec);
  if (dem.z_corrected) check_layer("z_corrected", *dem.z_corrected, spec);
  if (!dem.truth) return;
  check_layer("x_true", dem.truth->x, spec);
  check_layer("y_true", dem.truth->y, spec);
  check_layer("z_true", dem.truth->z, spec);
}

}  // namespace landfall
