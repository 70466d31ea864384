// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/thread_supply.h"

#include <latch>
#include <system_error>
#include <thread>
#include <vector>

namespace landfall {

std::size_t thread_supply(std::size_t wanted) {
  std::latch all_are_there(1);
  std::vector<std::jthread> threads;
  threads.reserve(wanted);
  try {
    while (threads.size() + 1 < wanted) threads.emplace_back([&all_are_there] { all_are_there.wait(); });
  } catch (const std::system_error&) {  // NOLINT(bugprone-empty-catch): no further thread is available
  }
  all_are_there.count_down();
  return threads.size() + 1;
}

}  // namespace landfall
