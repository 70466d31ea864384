// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace landfall {

/// How many draws are made at a time, and the number of threads for each.
struct DrawLanes {
  std::size_t draws = 1;
  std::size_t threads = 1;
  friend bool operator==(const DrawLanes& a, const DrawLanes& b) = default;
};

/// As many draws as threads, or as fit into half of the memory; the other half remains for the output and for
/// other programs. `bytes_each` is the memory of one draw, and `available` what further ones may take,
/// nothing if unknown.
[[nodiscard]] DrawLanes draw_lanes(std::size_t threads, std::uint64_t bytes_each,
                                   std::optional<std::uint64_t> available);

/// The work on draws. A lane, one of DrawLanes::draws, is the memory of one draw until it is added.
struct DrawWork {
  /// Whether a draw may begin; any thread calls it.
  std::function<bool()> begins;
  /// Makes a draw, on any thread and next to others.
  std::function<void(std::int64_t draw, std::size_t lane)> make;
  /// Takes a result, one after the other in the order of the draws. False: no further one is added.
  std::function<bool(std::int64_t draw, std::size_t lane)> add;
};

/// Makes the draws 0 .. count - 1 and adds them in order. If one may not begin, those before it are still
/// added. Returns false if not all were added. What `make` throws for a draw is rethrown in its turn, and so
/// not at all where the draws end before it; draws that have begun end first. Threads without a draw help
/// with the others.
bool make_draws(std::int64_t count, const DrawLanes& lanes, const DrawWork& work);

}  // namespace landfall
