// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D294
#include "chain/hazards/pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/numerics/portable_math.h"
#include "chain/hazards/measures.h"

namespace landfall {
namespace {

/// Calls each(bin, rows, cols from the centre) for the bins of a footprint, row by row.
template <class Each>
void for_bins(const Footprint& footprint, BinIndex centre, const Each& each) {
  for (std::int64_t r = -footprint.half_bins(); r <= footprint.half_bins(); ++r)
    for (std::int64_t c = -footprint.half_width(r); c <= footprint.half_width(r); ++c)
      each(BinIndex{centre.row + r, centre.col + c}, static_cast<double>(r), static_cast<double>(c));
}

/// NaN off the map.
double elevation(const Grid<double>& z, BinIndex bin) {
  return z.spec().contains(bin) ? z.at(bin) : std::numeric_limits<double>::quiet_NaN();
}

bool is_known(const Grid<double>& z, const Footprint& footprint, BinIndex centre) {
  bool known = true;
  for_bins(footprint, centre,
           [&](BinIndex bin, double, double) { known = known && std::isfinite(elevation(z, bin)); });
  return known;
}

/// The height of the ground under a pad, each bin of which is known.
double pad_height(const Grid<double>& z, const LanderStencil& lander, BinIndex pad) {
  double highest = -std::numeric_limits<double>::infinity();
  double sum = 0;
  for_bins(lander.pad, pad, [&](BinIndex bin, double, double) {
    highest = std::max(highest, z.at(bin));
    sum += z.at(bin);
  });
  return lander.pad_height == PadHeight::max ? highest : sum / static_cast<double>(lander.pad.bin_count());
}

/// Gives the pose the plane through three of its pads.
void stand_on(const std::array<std::size_t, 3>& pads, const GridSpec& spec, BinIndex place,
              LanderPose& pose) {
  const auto x_m = [&](const LanderPose::Pad& pad) { return spec.x(pad.bin.col) - spec.x(place.col); };
  const auto y_m = [&](const LanderPose::Pad& pad) { return spec.y(pad.bin.row) - spec.y(place.row); };
  const LanderPose::Pad& a = pose.pads[pads[0]];
  const LanderPose::Pad& b = pose.pads[pads[1]];
  const LanderPose::Pad& c = pose.pads[pads[2]];
  const double bx = x_m(b) - x_m(a);
  const double by = y_m(b) - y_m(a);
  const double cx = x_m(c) - x_m(a);
  const double cy = y_m(c) - y_m(a);
  const double determinant = bx * cy - cx * by;
  pose.east = ((b.z_m - a.z_m) * cy - (c.z_m - a.z_m) * by) / determinant;
  pose.north = ((c.z_m - a.z_m) * bx - (b.z_m - a.z_m) * cx) / determinant;
  pose.centre_z_m = a.z_m - pose.east * x_m(a) - pose.north * y_m(a);
  for (std::size_t leg = 0; leg < pose.pads.size(); ++leg)
    pose.pads[leg].touches = std::ranges::find(pads, leg) != pads.end();
}

/// Fills slope, roughness and the bin that decides it. `either_side`: below the plane counts, too.
void measure(const Grid<double>& z, const Footprint& body, BinIndex place, bool either_side,
             LanderPose& pose) {
  const double s = z.spec().resolution_m;
  const double gradient = portable::hypot(pose.east, pose.north);
  pose.slope_deg = slope_deg(gradient);
  double maximum = -std::numeric_limits<double>::infinity();
  for_bins(body, place, [&](BinIndex bin, double rows, double cols) {
    const double above = z.at(bin) - (pose.centre_z_m + pose.east * (cols * s) + pose.north * (rows * s));
    const double off = either_side ? std::abs(above) : above;
    if (off <= maximum) return;
    maximum = off;
    pose.highest = bin;
  });
  pose.roughness_m = maximum / std::sqrt(1 + gradient * gradient);
}

/// The pads of a plane; of four legs two planes: the diagonal that is higher on average and one other pad.
std::vector<std::array<std::size_t, 3>> stands(const std::vector<LanderPose::Pad>& pads) {
  if (pads.size() == 3) return {{0, 1, 2}};
  if (pads[0].z_m + pads[2].z_m >= pads[1].z_m + pads[3].z_m) return {{0, 2, 1}, {0, 2, 3}};
  return {{1, 3, 0}, {1, 3, 2}};
}

}  // namespace

std::optional<WorstPoses> worst_contact_poses(const Grid<double>& z, const LanderStencil& lander,
                                              BinIndex place) {
  if (!is_known(z, lander.body, place)) return {};
  std::optional<WorstPoses> worst;
  const double step_rad = 2 * std::numbers::pi / lander.legs / static_cast<double>(lander.yaws.size());
  for (std::size_t yaw = 0; yaw < lander.yaws.size(); ++yaw) {
    LanderPose pose;
    pose.yaw_rad = static_cast<double>(yaw) * step_rad;
    for (std::size_t leg = 0; leg < static_cast<std::size_t>(lander.legs); ++leg) {
      const BinOffset& offset = lander.yaws[yaw][leg];
      const BinIndex bin{place.row + offset.rows, place.col + offset.cols};
      if (!is_known(z, lander.pad, bin)) return {};
      pose.pads.push_back({bin, pad_height(z, lander, bin)});
    }
    for (const std::array<std::size_t, 3>& pads : stands(pose.pads)) {
      stand_on(pads, z.spec(), place, pose);
      measure(z, lander.body, place, false, pose);
      if (!worst) worst = {pose, pose};
      if (pose.slope_deg > worst->steepest.slope_deg) worst->steepest = pose;
      if (pose.roughness_m > worst->roughest.roughness_m) worst->roughest = pose;
    }
  }
  return worst;
}

std::optional<WorstPoses> least_squares_poses(const Grid<double>& z, const LanderStencil& lander,
                                              BinIndex place) {
  if (!is_known(z, lander.body, place)) return {};
  LanderPose pose;
  const double base = z.at(place);  // so that sums keep their digits
  double sum = 0;
  for_bins(lander.body, place, [&](BinIndex bin, double rows, double cols) {
    sum += z.at(bin) - base;
    pose.east += (z.at(bin) - base) * cols;
    pose.north += (z.at(bin) - base) * rows;
  });
  const double moment = static_cast<double>(lander.body.squared_offsets()) * z.spec().resolution_m;
  pose.east /= moment;
  pose.north /= moment;
  pose.centre_z_m = base + sum / static_cast<double>(lander.body.bin_count());
  measure(z, lander.body, place, true, pose);
  return WorstPoses{pose, pose};
}

}  // namespace landfall
