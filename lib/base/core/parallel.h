// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <string_view>

#include "base/core/progress.h"

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

/// Limits the number of threads of all parallel work during its lifetime; 0 means all cores.
class ThreadLimit {
 public:
  explicit ThreadLimit(std::size_t threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The number of threads that parallel work may use now.
[[nodiscard]] std::size_t thread_count();

/// Calls work(begin, end) over pieces of [0, count), each of at most `grain` items (grain >= 1), in any order
/// and on any thread. The pieces do not depend on the number of threads, so that work which writes only its
/// own items gives the same result on any machine. An exception thrown by work is rethrown here.
void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t begin, std::size_t end)>& work,
                  const ProgressCallback& progress = {});

/// Calls work so that a thread that waits inside it for parallel work takes no other task meanwhile. Work
/// that holds a lock needs this.
void run_isolated(const std::function<void()>& work);

/// Calls both at the same time if threads are available. An exception thrown by either is rethrown
/// here.
void run_both(const std::function<void()>& first, const std::function<void()>& second);

/// Calls produce(item, slot), then consume(item, slot) for every item of [0, count). Each of the two runs in
/// order and never concurrently with itself; later items are produced while earlier ones are consumed. At
/// most `slots` (>= 1) items exist at a time, and slot = item % slots: memory for `slots` items is enough. An
/// exception thrown by either is rethrown here.
void read_ahead(std::size_t count, std::size_t slots,
                const std::function<void(std::size_t item, std::size_t slot)>& produce,
                const std::function<void(std::size_t item, std::size_t slot)>& consume);

/// As read_ahead(), but produce runs for several items at once, on all threads.
void produce_in_parallel(std::size_t count, std::size_t slots,
                         const std::function<void(std::size_t item, std::size_t slot)>& produce,
                         const std::function<void(std::size_t item, std::size_t slot)>& consume);

}  // namespace landfall
