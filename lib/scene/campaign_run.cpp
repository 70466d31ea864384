// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/campaign_run.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "files/number_table.h"
#include "output/temporary_files.h"

namespace landfall {
namespace {

constexpr double kStateInterval_s = 30;

/// The draws of this run.
DrawSpan checked_span(const std::optional<DrawSpan>& part, const DrawsConfig& config) {
  if (!part) return {0, config.draw_count()};
  const std::string text = "--draws " + std::to_string(part->first) + ":" + std::to_string(part->end);
  if (config.sprt())
    throw UsageError(text + ": a sequential test cannot be divided; it decides after each draw");
  if (part->end > config.draw_count())
    throw UsageError(text + ": the campaign has " + std::to_string(config.draw_count()) + " draws");
  return *part;
}

/// Adds draws until the span, the rule or an interrupt ends the run, and keeps the state.
class DrawLoop {
 public:
  DrawLoop(Campaign& campaign, const DrawSpan& span, std::optional<Sprt> sprt, const CampaignState& state,
           const CampaignOutput& output)
      : campaign_(campaign), span_(span), sprt_(std::move(sprt)), state_(state), output_(output) {}

  void run(Draws& draws, const DeferredInterrupts& interrupts, const ProgressCallback& progress) {
    if (sprt_)
      for (const std::int8_t pass : draws.table.pass) sprt_->add(pass == 1);
    double saved_s = output_.clock_s();
    while (!is_done(draws) && !interrupts.requested()) {
      campaign_.run_next(draws);
      if (sprt_) sprt_->add(draws.table.pass.back() == 1);
      const std::vector<std::int8_t>& pass = draws.table.pass;
      output_.note(std::to_string(std::ranges::count(pass, 1)) + " of " + std::to_string(pass.size()) + " pass");
      report(progress, static_cast<double>(draws.table.end() - span_.first) /
                           static_cast<double>(span_.end - span_.first));
      if (output_.clock_s() - saved_s < kStateInterval_s || is_done(draws) || interrupts.requested()) continue;
      state_.save(draws, campaign_.crs_wkt());
      saved_s = output_.clock_s();
    }
    if (!interrupts.requested()) report(progress, 1);
  }

  /// What an interrupted run leaves.
  void keep(const Draws& draws) const {
    if (draws.table.size() == 0) return;
    state_.save(draws, campaign_.crs_wkt());
    output_.warn(std::to_string(draws.table.size()) + " of " + std::to_string(span_.end - span_.first) +
                 " draws are kept; the same command goes on after them");
  }

  [[nodiscard]] std::optional<SprtState> sprt_state() const {
    return sprt_ ? std::optional(sprt_->state()) : std::nullopt;
  }

 private:
  [[nodiscard]] bool is_done(const Draws& draws) const {
    return draws.table.end() >= span_.end || (sprt_ && sprt_->state() != SprtState::running);
  }

  Campaign& campaign_;
  DrawSpan span_;
  std::optional<Sprt> sprt_;
  const CampaignState& state_;
  const CampaignOutput& output_;
};

}  // namespace

CampaignResult run_campaign(const CampaignSources& sources, const std::optional<DrawSpan>& part,
                            CampaignOutput output) {
  const RangeFile scan(sources.scan);
  std::optional<NumberTable> samples;
  if (!sources.samples.empty()) {
    samples = read_number_table(sources.samples, {.all = true});
    output.provenance.add_input("samples", content_id(sources.samples), nlohmann::json::array());
  }
  const DrawsConfig config(output.provenance.config, output.config_name, scan.file().config(),
                           samples ? &*samples : nullptr);
  output.provenance.config = config.json();
  const DrawSpan span = checked_span(part, config);
  std::optional<Campaign> campaign;
  output.phase("read", [&](const ProgressCallback& progress) {
    campaign.emplace(scan, sources.terrain, config, span, output.provenance, progress);
  });
  const CampaignState state(output.file.path, output.provenance, span.first);
  if (span.first != 0 || span.end != config.draw_count())
    output.provenance.options = part_options(span.first, span.end);
  LandfallFileWriter file(output.file, "draws", output.provenance);
  Draws draws = state.load(output.warn).value_or(campaign->empty(span.first));
  const std::int64_t done = draws.table.size();
  if (done > 0) output.log("goes on after " + std::to_string(done) + " draws");
  std::optional<Sprt> sprt;
  if (config.sprt()) sprt.emplace(*config.sprt());
  DrawLoop loop(*campaign, span, std::move(sprt), state, output);
  const double began_s = output.clock_s();
  {
    const DeferredInterrupts interrupts;
    output.phase("draw", [&](const ProgressCallback& progress) { loop.run(draws, interrupts, progress); });
    if (interrupts.requested()) loop.keep(draws);
  }
  CampaignResult result{verdict_json(draws.table, loop.sprt_state()),
                        static_cast<double>(draws.table.size() - done) / (output.clock_s() - began_s)};
  const std::string crs_wkt = campaign->crs_wkt();
  campaign.reset();  // its memory is not needed to write the maps
  output.phase("write", [&](const ProgressCallback&) {
    if (output.report) output.report(draws, result.verdict, output.provenance);
    write_draws(file, draws, result.verdict, crs_wkt);
  });
  state.remove();
  return result;
}

}  // namespace landfall
