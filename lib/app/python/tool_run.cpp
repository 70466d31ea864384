// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/python/tool_run.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "app/cli/tool.h"
#include "base/core/standard_streams.h"

namespace landfall {
namespace {

/// The state that the run and the waiting thread share.
struct Shared {
  std::mutex lock;
  std::condition_variable ended;
  bool is_over = false;
  std::string phase;
  double fraction = 0;
  std::atomic<bool> cancelled = false;
};

cli::Host host_of(Shared& shared, ToolResult& result) {
  return {.warn = [&](const std::string& text) { result.warnings.push_back(text); },
          .fail = [&](const std::string& text) { result.message = text; },
          .progress =
              [&](const std::string& phase, double fraction) {
                if (shared.cancelled) throw cli::Interrupted();
                const std::lock_guard lock(shared.lock);
                shared.phase = phase;
                shared.fraction = fraction;
              }};
}

void run(const ToolProgram& tool, const ToolCommand& command, Shared& shared, ToolResult& result) {
  std::vector<const char*> argv;
  for (const std::string& word : command.words) argv.push_back(word.c_str());
  const cli::Host host = host_of(shared, result);
  cli::Invocation invocation{.host = &host};
  try {
    const GivenInput input(command.standard_input);
    const CapturedOutput text;
    result.code = tool(static_cast<int>(argv.size()), argv.data(), &invocation);
    result.printed = text.text();
  } catch (const cli::Interrupted&) {
    result.interrupted = true;
  }
  const std::lock_guard lock(shared.lock);
  shared.is_over = true;
  shared.ended.notify_one();
}

/// Ends the run when it goes out of scope, also by an exception.
class JoinedRun {
 public:
  JoinedRun(std::thread thread, Shared& shared) : thread_(std::move(thread)), shared_(shared) {}
  ~JoinedRun() {
    shared_.cancelled = true;
    thread_.join();
  }
  JoinedRun(const JoinedRun&) = delete;
  JoinedRun& operator=(const JoinedRun&) = delete;

 private:
  std::thread thread_;
  Shared& shared_;
};

}  // namespace

ToolResult run_tool(const ToolProgram& tool, const ToolCommand& command, const WaitingFunction& waiting) {
  using namespace std::chrono_literals;
  Shared shared;
  ToolResult result;
  if (!waiting) {
    run(tool, command, shared, result);
    return result;
  }
  const JoinedRun running(std::thread([&] { run(tool, command, shared, result); }), shared);
  std::unique_lock lock(shared.lock);
  while (!shared.ended.wait_for(lock, 20ms, [&] { return shared.is_over; })) {
    const std::string phase = shared.phase;
    const double fraction = shared.fraction;
    lock.unlock();
    if (waiting(phase, fraction)) shared.cancelled = true;
    lock.lock();
  }
  return result;
}

}  // namespace landfall
