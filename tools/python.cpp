// SPDX-License-Identifier: GPL-3.0-or-later
// The tools as functions of a process of Python.
#include <atomic>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "app/cli/tool.h"
#include "app/python/engine.h"
#include "base/core/standard_streams.h"
#include "tools.h"

namespace landfall::python {
namespace {

const std::map<std::string, ToolFunction*> kTools = {{"terrain-gen", terrain_gen::start},
                                                     {"scan-sim", scan_sim::start},
                                                     {"regrid", regrid::start},
                                                     {"dem-eval", dem_eval::start},
                                                     {"hazard-map", hazard_map::start},
                                                     {"monte-carlo", monte_carlo::start},
                                                     {"landfall-import", landfall_import::start},
                                                     {"landfall run", landfall_run::start}};

class Run : public Object {
 public:
  Run(std::vector<std::string> words, std::string standard_input)
      : tool_(kTools.at(words.at(0))), words_(std::move(words)), standard_input_(std::move(standard_input)) {}

  void start() {
    std::vector<const char*> argv;
    for (const std::string& word : words_) argv.push_back(word.c_str());
    const cli::Host host = {
        .warn = [&](const std::string& text) { warnings_.push_back(text); },
        .fail = [&](const std::string& text) { message_ = text; },
        .progress = [&](const std::string& phase, double fraction) { pass(phase, fraction); }};
    cli::Invocation invocation{.host = &host};
    try {
      const GivenInput input(standard_input_);
      const CapturedOutput text;
      code_ = tool_(static_cast<int>(argv.size()), argv.data(), &invocation);
      printed_ = text.text();
    } catch (const cli::Interrupted&) {  // by Python, which asks for no result then
    }
  }

  [[nodiscard]] std::string phase(double& fraction) const {
    const std::lock_guard lock(lock_);
    fraction = fraction_;
    return phase_;
  }

  void cancel() { is_cancelled_ = true; }

  [[nodiscard]] std::string result() const {
    return nlohmann::json({code_, message_, warnings_, printed_})
        .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  }

 private:
  void pass(const std::string& phase, double fraction) {
    if (is_cancelled_) throw cli::Interrupted();
    const std::lock_guard lock(lock_);
    phase_ = phase;
    fraction_ = fraction;
  }

  ToolFunction* tool_;
  std::vector<std::string> words_;
  std::string standard_input_;
  std::atomic<bool> is_cancelled_ = false;
  mutable std::mutex lock_;  ///< of the phase and its fraction
  std::string phase_;
  double fraction_ = 0;
  int code_ = 0;
  std::string message_;
  std::vector<std::string> warnings_;
  std::string printed_;
};

}  // namespace

Object* landfall_new_run(const char* const* words, std::size_t count, const char* standard_input,
                         std::size_t size) {
  return object_of([&] {
    return new Run(std::vector<std::string>(words, words + count), std::string(standard_input, size));
  });
}

bool landfall_run_start(Object* run) {
  return succeeds([&] { as<Run>(run).start(); });
}

const char* landfall_run_phase(Object* run, double* fraction) {
  return text_of([&] { return as<Run>(run).phase(*fraction); });
}

bool landfall_run_cancel(Object* run) {
  return succeeds([&] { as<Run>(run).cancel(); });
}

const char* landfall_run_result(Object* run) {
  return text_of([&] { return as<Run>(run).result(); });
}

}  // namespace landfall::python
