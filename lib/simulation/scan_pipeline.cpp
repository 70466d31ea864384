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

/// The three stages, and what they share.
class ScanPipeline {
 public:
  ScanPipeline(const Simulation& simulation, const RangeSource& ranges, const BatchSink& sink)
      : simulation_(simulation), ranges_(ranges), sink_(sink) {}

  TaskPtr next_task(std::int64_t pulses_per_batch, tbb::flow_control& control) {
    if (next_pulse_ >= simulation_.pulse_count()) {
      control.stop();
      return nullptr;
    }
    const PulseRange pulses{next_pulse_, std::min(pulses_per_batch, simulation_.pulse_count() - next_pulse_)};
    next_pulse_ += pulses.count;
    if (!ranges_) return std::make_shared<Task>(Task{pulses, {}});
    return std::make_shared<Task>(Task{pulses, ranges_(pulses)});
  }

  Simulated simulate(const Task& task) {
    Simulated result{pool_.take(), nullptr};
    try {
      if (ranges_) {
        simulation_.replay(task.pulses, task.ranges_true_m, *result.batch);
      } else {
        simulation_.simulate(task.pulses, *result.batch);
      }
    } catch (...) {
      result.failure = std::current_exception();
    }
    return result;
  }

  void give_to_sink(const Simulated& simulated, const ProgressCallback& progress) {
    if (simulated.failure) std::rethrow_exception(simulated.failure);
    BatchPtr batch = simulated.batch;
    pulses_done_ += static_cast<std::int64_t>(batch->pulses.size());
    sink_(*batch);
    pool_.give_back(std::move(batch));
    report(progress, static_cast<double>(pulses_done_) / static_cast<double>(simulation_.pulse_count()));
  }

 private:
  const Simulation& simulation_;
  const RangeSource& ranges_;
  const BatchSink& sink_;
  BatchPool pool_;
  std::int64_t next_pulse_ = 0;
  std::int64_t pulses_done_ = 0;
};

}  // namespace

void run_scan(const Simulation& simulation, const RangeSource& ranges, const BatchSink& sink,
              std::int64_t points_per_batch, const ProgressCallback& progress) {
  ScanPipeline pipeline(simulation, ranges, sink);
  const auto pixels = static_cast<std::int64_t>(simulation.pixel_count());
  const std::int64_t pulses_per_batch = std::max<std::int64_t>(1, points_per_batch / pixels);
  using tbb::filter_mode;
  tbb::parallel_pipeline(
      2 * thread_count(),
      tbb::make_filter<void, TaskPtr>(filter_mode::serial_in_order, [&](tbb::flow_control& control) {
        return pipeline.next_task(pulses_per_batch, control);
      }) & tbb::make_filter<TaskPtr, Simulated>(filter_mode::parallel, [&](const TaskPtr& task) {
        return pipeline.simulate(*task);
      }) & tbb::make_filter<Simulated, void>(filter_mode::serial_in_order, [&](const Simulated& simulated) {
        pipeline.give_to_sink(simulated, progress);
      }));
}

}  // namespace landfall
