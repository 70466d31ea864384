// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/core/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <latch>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "base/core/thread_share.h"

namespace landfall {
namespace {

thread_local std::size_t share_of_threads =
    std::numeric_limits<std::size_t>::max();  // NOLINT(*-avoid-non-const-global-variables)

using ItemWork = std::function<void(std::size_t item, std::size_t slot)>;

void run_pipeline(std::size_t count, std::size_t slots, tbb::filter_mode produce_mode,
                  const ItemWork& produce, const ItemWork& consume) {
  using tbb::filter_mode;
  std::size_t next = 0;
  const auto next_item = [&](tbb::flow_control& control) {
    if (next == count) control.stop();
    return next == count ? next : next++;
  };
  const auto produce_item = [&](std::size_t item) {
    produce(item, item % slots);
    return item;
  };
  const auto consume_item = [&](std::size_t item) { consume(item, item % slots); };
  tbb::parallel_pipeline(slots,
                         tbb::make_filter<void, std::size_t>(filter_mode::serial_in_order, next_item) &
                             tbb::make_filter<std::size_t, std::size_t>(produce_mode, produce_item) &
                             tbb::make_filter<std::size_t, void>(filter_mode::serial_in_order, consume_item));
}

}  // namespace

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

struct ThreadLimit::Impl {
  tbb::global_control control;
  explicit Impl(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
};

ThreadLimit::ThreadLimit(std::size_t threads) {
  const auto cores = static_cast<std::size_t>(tbb::info::default_concurrency());
  impl_ = std::make_unique<Impl>(thread_supply(threads == 0 ? cores : threads));
}

ThreadLimit::~ThreadLimit() = default;

std::size_t thread_count() {
  return std::min(share_of_threads,
                  tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_for(std::size_t count, std::size_t grain,
                  const std::function<void(std::size_t, std::size_t)>& work,
                  const ProgressCallback& progress) {
  grain = std::max<std::size_t>(grain, 1);
  const std::size_t pieces = (count + grain - 1) / grain;
  std::mutex progress_mutex;
  std::size_t done = 0;
  const auto run_piece = [&](std::size_t piece) {
    work(piece * grain, std::min(count, (piece + 1) * grain));
    if (!progress) return;
    const std::lock_guard lock(progress_mutex);
    ++done;
    progress(static_cast<double>(done) / static_cast<double>(pieces));
  };
  // Isolation keeps a waiting thread from starting unrelated outer work, for example a pipeline stage.
  tbb::this_task_arena::isolate(
      [&] { tbb::parallel_for(std::size_t{0}, pieces, run_piece, tbb::simple_partitioner{}); });
  if (pieces == 0) report(progress, 1.0);
}

void run_isolated(const std::function<void()>& work) { tbb::this_task_arena::isolate(work); }

void run_with_share(std::size_t threads, const std::function<void()>& work) {
  struct Share {
    explicit Share(std::size_t threads) : before(std::exchange(share_of_threads, threads)) {}
    ~Share() { share_of_threads = before; }
    std::size_t before;
  };
  const Share share(threads);
  work();
}

void run_both(const std::function<void()>& first, const std::function<void()>& second) {
  tbb::this_task_arena::isolate([&] { tbb::parallel_invoke(first, second); });
}

void read_ahead(std::size_t count, std::size_t slots, const ItemWork& produce, const ItemWork& consume) {
  run_pipeline(count, slots, tbb::filter_mode::serial_in_order, produce, consume);
}

void produce_in_parallel(std::size_t count, std::size_t slots, const ItemWork& produce,
                         const ItemWork& consume) {
  run_pipeline(count, slots, tbb::filter_mode::parallel, produce, consume);
}

}  // namespace landfall
