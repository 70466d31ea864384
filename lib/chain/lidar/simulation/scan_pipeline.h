// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "base/core/progress.h"
#include "chain/lidar/simulation/simulation.h"

namespace landfall {

/// The true ranges of consecutive pulses, one per pixel and pulse, NaN for a miss, and the echoes, where the
/// receiver sees waveforms.
struct RecordedRanges {
  std::vector<double> ranges_m;
  std::vector<Echo> echoes{};
  std::vector<LaterEcho> later{};
};
using RangeSource = std::function<RecordedRanges(PulseSpan pulses)>;

/// The source of true ranges from an earlier run.
struct Replay {
  RangeSource ranges{};                      ///< empty: trace the rays
  PointContent content = PointContent::all;  ///< the columns that the batches hold
  bool keep_echoes = false;                  ///< the batches also hold the echoes; also of traced rays
};

/// The remaining work after a sink has taken a batch. Either function may be empty.
struct SinkWork {
  std::function<void()> in_parallel;  ///< on any thread, at the same time as other batches' work
  std::function<void()> in_order;     ///< afterwards, one at a time, in the order of the batches
};

/// Takes the next batch. It may change the batch but must not keep it.
using BatchSink = std::function<SinkWork(PulseBatch& batch)>;

/// Simulates all pulses of a scan on all threads, batch by batch, and passes the batches to `sink` in
/// order. If `replay` has ranges, nothing is traced: the true ranges come from it, requested in order. One
/// thread at a time calls the source, the sink and the work in order, but these calls may overlap with each
/// other.
///
/// Throws what the simulation, the source or the sink throws; if several pulses fail, the error of the first.
/// Only a few batches per thread exist at a time: memory does not depend on the number of pulses. The result
/// depends neither on the number of threads nor on points_per_batch.
void run_scan(const Simulation& simulation, const Replay& replay, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress = {});

}  // namespace landfall
