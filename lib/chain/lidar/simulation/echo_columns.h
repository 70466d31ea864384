// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include "base/returns/columns.h"
#include "chain/lidar/receiver/echo.h"

namespace landfall {

/// A member of Echo and the columns that keep it.
struct EchoMember {
  double Echo::*member;
  std::vector<double> PointColumns::*first;  ///< of the pixels' first or chosen echoes
  std::vector<double> EchoColumns::*later;   ///< of the echoes behind the first ones
};

inline constexpr std::array kEchoMembers = {
    EchoMember{&Echo::signal_pe, &PointColumns::echo_signal, &EchoColumns::signal},
    EchoMember{&Echo::peak, &PointColumns::echo_peak, &EchoColumns::peak},
    EchoMember{&Echo::edge_m, &PointColumns::echo_edge, &EchoColumns::edge},
    EchoMember{&Echo::width_m, &PointColumns::echo_width, &EchoColumns::width},
    EchoMember{&Echo::range_m, &PointColumns::echo_range, &EchoColumns::range}};
static_assert(sizeof(Echo) == kEchoMembers.size() * sizeof(double));

}  // namespace landfall
