// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "simulation/simulation.h"

namespace landfall {

/// The true ranges of consecutive pulses, one per pixel and pulse, NaN for a miss.
using RangeSource = std::function<std::vector<double>(PulseSpan pulses)>;

/// An earlier run to take the true ranges from.
struct Replay {
  RangeSource ranges{};                      ///< none: trace
  PointContent content = PointContent::all;  ///< what the batches are to hold
};

/// What is left to do when a sink has taken a batch; either may be empty.
struct SinkWork {
  std::function<void()> in_parallel;  ///< on any thread, at the same time as other batches' work
  std::function<void()> in_order;     ///< afterwards, one at a time, in the order of the batches
};

/// Takes the next batch; may change it, and has no use of it afterwards.
using BatchSink = std::function<SinkWork(PulseBatch& batch)>;

/// Simulates all pulses of a scan on all threads, batch by batch, and gives the batches to `sink` in order.
/// Where `replay` has ranges nothing is traced: the true ranges come from there, asked for in order. Each of
/// the source, the sink and the work in order is called by one thread at a time, but they may run at the same
/// time as each other.
///
/// Throws what simulating, the source or the sink throws; where several pulses fail, for the first of them.
/// Only a few batches per thread exist at a time: memory does not depend on the number of pulses. The result
/// depends on neither threads nor points_per_batch.
void run_scan(const Simulation& simulation, const Replay& replay, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress = {});

}  // namespace landfall
