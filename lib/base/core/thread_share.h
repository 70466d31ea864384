// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace landfall {

/// Calls work, in which thread_count() is at most `threads`, while the other threads have work of their own.
/// Threads that are idle still take parts of its parallel work.
void run_with_share(std::size_t threads, const std::function<void()>& work);

}  // namespace landfall
