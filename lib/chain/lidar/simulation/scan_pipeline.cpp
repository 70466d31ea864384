// SPDX-License-Identifier: GPL-3.0-or-later
// Only the writing of a scan is in order. Chunks are compressed, and those of `--ranges-from` read, on any
// thread; the layout of a file follows from the order in which chunks are written, which is that of the
// pulses.
#include "chain/lidar/simulation/scan_pipeline.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>
#include <utility>

#include "base/core/parallel.h"

namespace landfall {
namespace {

using BatchPtr = std::unique_ptr<PulseBatch>;

/// A batch of pulses that passes through the stages.
struct Passage {
  PulseSpan pulses;
  RecordedRanges truth;  ///< unused where rays are traced
  BatchPtr batch;
  /// Why there is no batch. It is thrown when the batch's turn comes, so that the error names the first pulse
  /// that fails, for any number of threads.
  std::exception_ptr failure;
  SinkWork work;
};

/// A pool of unused batches, so that their memory is allocated and touched only once.
class BatchPool {
 public:
  BatchPtr take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_unique<PulseBatch>();
    BatchPtr batch = std::move(free_.back());
    free_.pop_back();
    return batch;
  }

  void give_back(BatchPtr batch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(batch));
  }

 private:
  std::mutex mutex_;
  std::vector<BatchPtr> free_;
};

/// The stages and their shared state. They pass pointers, which the pipeline owns: oneTBB does not destroy
/// what a failing run leaves between two stages.
class ScanPipeline {
 public:
  /// The largest number of batches in the pipeline at once.
  ScanPipeline(const Simulation& simulation, const Replay& replay, const BatchSink& sink,
               std::size_t max_passages)
      : simulation_(simulation), replay_(replay), sink_(sink), passages_(max_passages) {}

  Passage* next(std::int64_t pulses_per_batch, tbb::flow_control& control) {
    if (next_pulse_ >= simulation_.pulse_count()) {
      control.stop();
      return nullptr;
    }
    // The last stage runs in order, so the previous user of this slot is done.
    Passage& passage = passages_[begun_++ % passages_.size()];
    passage.pulses = {next_pulse_, std::min(pulses_per_batch, simulation_.pulse_count() - next_pulse_)};
    next_pulse_ += passage.pulses.count;
    if (replay_.ranges) passage.truth = replay_.ranges(passage.pulses);
    return &passage;
  }

  void simulate(Passage& passage) {
    passage.batch = pool_.take();
    try {
      if (replay_.ranges) {
        simulation_.replay(passage.pulses,
                           {passage.truth.ranges_m, passage.truth.echoes, passage.truth.later},
                           *passage.batch, replay_.content, replay_.keep_echoes);
      } else {
        simulation_.simulate(passage.pulses, *passage.batch, replay_.keep_echoes);
      }
    } catch (...) {
      passage.failure = std::current_exception();
    }
  }

  void give_to_sink(Passage& passage) {
    if (passage.failure) std::rethrow_exception(passage.failure);
    passage.work = sink_(*passage.batch);
    pool_.give_back(std::move(passage.batch));
  }

  void finish(Passage& passage, const ProgressCallback& progress) {
    if (passage.work.in_order) passage.work.in_order();
    passage.work = {};
    pulses_done_ += passage.pulses.count;
    report(progress, static_cast<double>(pulses_done_) / static_cast<double>(simulation_.pulse_count()));
  }

 private:
  const Simulation& simulation_;
  const Replay& replay_;
  const BatchSink& sink_;
  BatchPool pool_;
  std::vector<Passage> passages_;
  std::size_t begun_ = 0;
  std::int64_t next_pulse_ = 0;
  std::int64_t pulses_done_ = 0;
};

}  // namespace

void run_scan(const Simulation& simulation, const Replay& replay, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress) {
  const std::size_t max_passages = 4 * thread_count();
  ScanPipeline pipeline(simulation, replay, sink, max_passages);
  const auto pixels = static_cast<std::int64_t>(simulation.pixel_count());
  const std::int64_t pulses_per_batch = std::max<std::int64_t>(1, points_per_batch / pixels);
  using enum tbb::filter_mode;
  const auto next = tbb::make_filter<void, Passage*>(
      serial_in_order, [&](tbb::flow_control& control) { return pipeline.next(pulses_per_batch, control); });
  const auto simulate = tbb::make_filter<Passage*, Passage*>(parallel, [&](Passage* passage) {
    pipeline.simulate(*passage);
    return passage;
  });
  const auto take = tbb::make_filter<Passage*, Passage*>(serial_in_order, [&](Passage* passage) {
    pipeline.give_to_sink(*passage);
    return passage;
  });
  const auto work = tbb::make_filter<Passage*, Passage*>(parallel, [](Passage* passage) {
    if (passage->work.in_parallel) passage->work.in_parallel();
    return passage;
  });
  const auto finish = tbb::make_filter<Passage*, void>(
      serial_in_order, [&](Passage* passage) { pipeline.finish(*passage, progress); });
  tbb::parallel_pipeline(max_passages, next & simulate & take & work & finish);
}

}  // namespace landfall
