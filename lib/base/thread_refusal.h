// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <exception>
#include <string_view>

namespace landfall {

/// Whether an exception means that the system refused another thread: oneTBB then throws a plain
/// runtime_error wherever parallel work begins.
[[nodiscard]] inline bool is_thread_refusal(const std::exception& error) {
  return std::string_view(error.what()).starts_with("pthread_create");
}

}  // namespace landfall
