// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/scan_pipeline.h"

#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <exception>
#include <memory>
#include <mutex>

#include "base/parallel.h"

namespace landfall {
namespace {

struct Task {
  PulseRange pulses;
  std::vector<double> ranges_true_m;  ///< empty: trace
};

using TaskPtr = std::shared_ptr<Task>;
using BatchPtr = std::shared_ptr<PulseBatch>;

/// A batch, or why there is none. Thrown only in its turn, so that the first pulse that fails is the one
/// named, on any number of threads.
struct Simulated {
  BatchPtr batch;
  std::exception_ptr failure;
};

/// Batches that are not in use: their memory is touched for the first time only once.
class BatchPool {
 public:
  BatchPtr take() {
    const std::lock_guard lock(mutex_);
    if (free_.empty()) return std::make_shared<PulseBatch>();
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

/// What became of a batch: work, and its pulses.
struct Taken {
  SinkWork work;
  std::int64_t pulse_count = 0;
};

using TakenPtr = std::shared_ptr<Taken>;

/// The stages, and what they share.
class ScanPipeline {
 public:
  ScanPipeline(const Simulation& simulation, const Replay& replay, const BatchSink& sink)
      : simulation_(simulation), replay_(replay), sink_(sink) {}

  TaskPtr next_task(std::int64_t pulses_per_batch, tbb::flow_control& control) {
    if (next_pulse_ >= simulation_.pulse_count()) {
      control.stop();
      return nullptr;
    }
    const PulseRange pulses{next_pulse_, std::min(pulses_per_batch, simulation_.pulse_count() - next_pulse_)};
    next_pulse_ += pulses.count;
    if (!replay_.ranges) return std::make_shared<Task>(Task{pulses, {}});
    return std::make_shared<Task>(Task{pulses, replay_.ranges(pulses)});
  }

  Simulated simulate(const Task& task) {
    Simulated result{pool_.take(), nullptr};
    try {
      if (replay_.ranges) {
        simulation_.replay(task.pulses, task.ranges_true_m, *result.batch, replay_.content);
      } else {
        simulation_.simulate(task.pulses, *result.batch);
      }
    } catch (...) {
      result.failure = std::current_exception();
    }
    return result;
  }

  TakenPtr give_to_sink(const Simulated& simulated) {
    if (simulated.failure) std::rethrow_exception(simulated.failure);
    auto taken = std::make_shared<Taken>(
        Taken{sink_(*simulated.batch), static_cast<std::int64_t>(simulated.batch->pulses.size())});
    pool_.give_back(simulated.batch);
    return taken;
  }

  void finish(const Taken& taken, const ProgressCallback& progress) {
    if (taken.work.in_order) taken.work.in_order();
    pulses_done_ += taken.pulse_count;
    report(progress, static_cast<double>(pulses_done_) / static_cast<double>(simulation_.pulse_count()));
  }

 private:
  const Simulation& simulation_;
  const Replay& replay_;
  const BatchSink& sink_;
  BatchPool pool_;
  std::int64_t next_pulse_ = 0;
  std::int64_t pulses_done_ = 0;
};

}  // namespace

void run_scan(const Simulation& simulation, const Replay& replay, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress) {
  ScanPipeline pipeline(simulation, replay, sink);
  const auto pixels = static_cast<std::int64_t>(simulation.pixel_count());
  const std::int64_t pulses_per_batch = std::max<std::int64_t>(1, points_per_batch / pixels);
  using enum tbb::filter_mode;
  const auto next = tbb::make_filter<void, TaskPtr>(serial_in_order, [&](tbb::flow_control& control) {
    return pipeline.next_task(pulses_per_batch, control);
  });
  const auto simulate = tbb::make_filter<TaskPtr, Simulated>(
      parallel, [&](const TaskPtr& task) { return pipeline.simulate(*task); });
  const auto take = tbb::make_filter<Simulated, TakenPtr>(
      serial_in_order, [&](const Simulated& simulated) { return pipeline.give_to_sink(simulated); });
  const auto work = tbb::make_filter<TakenPtr, TakenPtr>(parallel, [](const TakenPtr& taken) {
    if (taken->work.in_parallel) taken->work.in_parallel();
    return taken;
  });
  const auto finish = tbb::make_filter<TakenPtr, void>(
      serial_in_order, [&](const TakenPtr& taken) { pipeline.finish(*taken, progress); });
  tbb::parallel_pipeline(4 * thread_count(), next & simulate & take & work & finish);
}

}  // namespace landfall
