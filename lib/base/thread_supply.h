// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>

namespace landfall {

/// How many threads, up to `wanted` and this one among them, the system lets run at the same time now (ulimit
/// -u, or memory for their stacks): 1 at least. oneTBB fails and GDAL blocks where one of its threads is
/// refused. Some 20 microseconds a thread.
[[nodiscard]] std::size_t thread_supply(std::size_t wanted);

}  // namespace landfall
