// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/progress.h"
#include "simulation/simulation.h"

namespace landfall {

/// The true ranges of consecutive pulses, one per pixel and pulse, NaN for a miss.
using RangeSource = std::function<std::vector<double>(PulseRange pulses)>;

/// Takes the next batch; may change it.
using BatchSink = std::function<void(PulseBatch& batch)>;

/// Simulates all pulses of a scan on all threads, batch by batch, and gives the batches to `sink` in order.
/// With `ranges` nothing is traced: the true ranges come from it, asked for in order. Each of the two is
/// called by one thread at a time, but `sink` and `ranges` may run at the same time.
///
/// Throws what simulating, `ranges` or `sink` throws; where several pulses fail, for the first of them. Only
/// a few batches per thread exist at a time: memory does not depend on the number of pulses. The result
/// depends on neither threads nor points_per_batch.
void run_scan(const Simulation& simulation, const RangeSource& ranges, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress = {});

}  // namespace landfall
