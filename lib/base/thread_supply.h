// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <string_view>

namespace landfall {

/// The number of threads, this one included, that the system allows to run at the same time now (ulimit -u,
/// or memory for their stacks): at least 1, at most `wanted`. Needed because oneTBB fails and GDAL blocks if
/// one of their threads is refused. Takes about 20 microseconds per thread.
[[nodiscard]] std::size_t thread_supply(std::size_t wanted);

/// Whether an exception means that the system refused another thread: oneTBB then throws a plain
/// runtime_error wherever parallel work begins.
[[nodiscard]] inline bool is_thread_refusal(const std::exception& error) {
  return std::string_view(error.what()).starts_with("pthread_create");
}

}  // namespace landfall
