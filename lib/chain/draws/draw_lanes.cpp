// SPDX-License-Identifier: GPL-3.0-or-later
// Decisions: D458
#include "chain/draws/draw_lanes.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <numeric>
#include <vector>

#include "base/core/parallel.h"
#include "base/core/thread_share.h"

namespace landfall {
namespace {

/// Draws on several lanes. Nothing is thrown within the pipeline, because that would end the loops of the
/// other draws in the middle.
class SideBySide {
 public:
  SideBySide(const DrawLanes& lanes, const DrawWork& work)
      : lanes_(lanes), work_(work), made_(lanes.draws), free_lanes_(lanes.draws) {
    std::iota(free_lanes_.rbegin(), free_lanes_.rend(), std::size_t{0});
  }

  bool run(std::size_t count) {
    produce_in_parallel(
        count, made_.size(), [this](std::size_t draw, std::size_t slot) { made_[slot] = make(draw); },
        [this](std::size_t draw, std::size_t slot) { add(draw, made_[slot]); });
    if (error_) std::rethrow_exception(error_);
    return !has_ended_;
  }

 private:
  struct Made {
    std::optional<std::size_t> lane{};  ///< none: the draw did not begin
    std::exception_ptr error{};
  };

  Made make(std::size_t draw) {
    if (has_ended_ || !work_.begins()) return {};
    Made made{.lane = take_lane()};
    try {
      run_with_share(lanes_.threads, [&] { work_.make(static_cast<std::int64_t>(draw), *made.lane); });
    } catch (...) {
      made.error = std::current_exception();
    }
    return made;
  }

  void add(std::size_t draw, const Made& made) {
    if (!has_ended_) {
      try {
        if (made.error) std::rethrow_exception(made.error);
        bool continues = made.lane.has_value();
        if (continues)
          run_isolated([&] { continues = work_.add(static_cast<std::int64_t>(draw), *made.lane); });
        if (!continues) has_ended_ = true;
      } catch (...) {
        error_ = std::current_exception();
        has_ended_ = true;
      }
    }
    if (made.lane) give_back(*made.lane);
  }

  /// One is free, because there are as many as draws at a time. The last one that was used is in the caches.
  std::size_t take_lane() {
    const std::lock_guard lock(mutex_);
    const std::size_t lane = free_lanes_.back();
    free_lanes_.pop_back();
    return lane;
  }
  void give_back(std::size_t lane) {
    const std::lock_guard lock(mutex_);
    free_lanes_.push_back(lane);
  }

  const DrawLanes& lanes_;
  const DrawWork& work_;
  std::vector<Made> made_;  ///< by slot
  std::mutex mutex_;
  std::vector<std::size_t> free_lanes_;
  std::atomic<bool> has_ended_ = false;
  std::exception_ptr error_;
};

}  // namespace

DrawLanes draw_lanes(std::size_t threads, std::uint64_t bytes_each, std::optional<std::uint64_t> available) {
  std::uint64_t fitting = threads;
  if (available && bytes_each > 0) fitting = (*available / 2 + bytes_each / 2) / bytes_each;
  const std::size_t draws = std::clamp<std::uint64_t>(fitting, 1, std::max<std::size_t>(threads, 1));
  return {draws, (threads + draws - 1) / draws};
}

bool make_draws(std::int64_t count, const DrawLanes& lanes, const DrawWork& work) {
  if (lanes.draws > 1) return SideBySide(lanes, work).run(static_cast<std::size_t>(count));
  for (std::int64_t draw = 0; draw < count; ++draw) {
    if (!work.begins()) return false;
    work.make(draw, 0);
    if (!work.add(draw, 0)) return false;
  }
  return true;
}

}  // namespace landfall
