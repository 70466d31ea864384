// SPDX-License-Identifier: GPL-3.0-or-later
// The first interrupt waits for the draws that have begun and the state, a second one does not. Batch systems
// send SIGTERM some seconds before SIGKILL, and a draw takes less, as a rule. Writing a state does not decide
// the end of the run (lib/base/output/temporary_files.h), because interrupts are deferred while it is named.
#include "app/runs/draws_run.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "base/output/temporary_files.h"
#include "base/text/number_text.h"
#include "store/config/path_names.h"
#include "store/files/draws_verdict.h"
#include "store/files/table_reader.h"

namespace landfall {
namespace {

constexpr double kStateInterval_s = 30;
constexpr double kDisk_MB = 80e-6;  ///< per bin: states of 38 bytes (measured, with sigmas), two at a time

/// The scans of a run of draws, one after the other in memory.
class ScanSequence {
 public:
  /// `resolved` is the configuration of monte-carlo.
  ScanSequence(const DrawsSources& sources, nlohmann::json resolved, const std::string& name,
               const NumberTable* samples, std::function<void(const std::string&)> warn)
      : device_(sources.device),
        make_terrain_(sources.make_terrain),
        rules_(sources.rules),
        warn_(std::move(warn)) {
    if (sources.pairs.size() > 1) resolved["layers"] = false;
    for (const ScanPair& pair : sources.pairs)
      scans_.push_back(std::make_unique<Scan>(pair, resolved, name, samples));
    if (config().sprt() && has_pairs())
      throw UsageError(name + ": /stop: a sequential test decides on one scan, and --pair gives " +
                       std::to_string(scans_.size()));
    json_ = config().json();
    if (has_pairs()) json_["scan"] = resolved.at("scan");  // merged over several
  }

  [[nodiscard]] bool has_pairs() const { return scans_.size() > 1; }
  [[nodiscard]] const DrawsConfig& config() const { return scans_.front()->config; }
  [[nodiscard]] const nlohmann::json& json() const { return json_; }
  /// Draws over all scans.
  [[nodiscard]] std::int64_t row_count() const {
    return static_cast<std::int64_t>(scans_.size()) * config().draw_count();
  }
  /// The rows of this run.
  [[nodiscard]] DrawSpan checked_span(const std::optional<DrawSpan>& part) const {
    if (!part) return {0, row_count()};
    const std::string text = "--draws " + std::to_string(part->first) + ":" + std::to_string(part->end);
    if (config().sprt())
      throw UsageError(text + ": a sequential test cannot be divided; it decides after each draw");
    if (part->end > row_count())
      throw UsageError(text + ": the run has " + std::to_string(row_count()) + " draws");
    return *part;
  }

  /// Reads and checks every scan that has rows in the span, before any is drawn.
  void check(const DrawSpan& span, Provenance& provenance, const ProgressCallback& progress) {
    span_ = span;
    for (std::size_t pair = 0; pair < scans_.size(); ++pair) load(pair, provenance, progress);
  }

  /// The run of draws of a row.
  [[nodiscard]] DrawSeries& of(std::int64_t row) {
    const auto pair = static_cast<std::size_t>(row / config().draw_count());
    Provenance recorded;  // by check()
    if (!series_ || pair != loaded_) load(pair, recorded, {});
    return *series_;
  }

  /// The rows of the same run of draws from `row` to the end of the span.
  [[nodiscard]] std::int64_t rows_from(std::int64_t row) const {
    return std::min((row / config().draw_count() + 1) * config().draw_count(), span_.end) - row;
  }

  /// Adds the remaining results of a device to the maps.
  void complete(Draws& draws) { series_->complete(draws); }

  /// The frame of the scan in memory; with several it is not written, because there are no maps.
  [[nodiscard]] const std::string& crs_wkt() const { return series_->crs_wkt(); }

  /// Frees the memory of the scan.
  void clear() { series_.reset(); }

 private:
  struct Scan {
    Scan(const ScanPair& pair, const nlohmann::json& resolved, const std::string& name,
         const NumberTable* samples)
        : file(pair.scan.empty() ? nullptr : std::make_unique<RangeFile>(pair.scan)),
          terrain(pair.terrain),
          config(resolved, name, file ? file->file().config() : nlohmann::json(), samples) {
      if (config.traces()) require_one_terrain();
    }
    void require_one_terrain() const {
      const bool has_section = !config.stages().terrain.is_null();
      if (has_section && !terrain.empty())
        throw UsageError("--terrain " + terrain + ": " + config.name() +
                         " has a section terrain; give one of them");
      if (!has_section && terrain.empty())
        throw UsageError("draws that trace need a terrain: --terrain, or the section terrain of " +
                         config.name());
    }

    std::unique_ptr<RangeFile> file;  ///< null for draws that trace
    std::string terrain;
    DrawsConfig config;
  };

  void load(std::size_t pair, Provenance& provenance, const ProgressCallback& progress) {
    series_.reset();  // the old one first, so that both never exist at once
    const Scan& scan = *scans_[pair];
    const std::int64_t draws = scan.config.draw_count();
    const auto begin = static_cast<std::int64_t>(pair) * draws;
    const DrawSpan span = {std::clamp<std::int64_t>(span_.first - begin, 0, draws),
                           std::clamp<std::int64_t>(span_.end - begin, 0, draws)};
    const auto number = has_pairs() ? std::optional(static_cast<std::int64_t>(pair)) : std::nullopt;
    TerrainSource terrain{scan.terrain, make_terrain_, warn_, rules_};
    if (scan.file)
      series_ = std::make_unique<DrawSeries>(*scan.file, std::move(terrain), scan.config, span, number,
                                             device_, provenance, progress);
    else
      series_ = std::make_unique<DrawSeries>(std::move(terrain), scan.config, span, provenance);
    loaded_ = pair;
  }

  std::optional<OpenClOptions> device_;
  TerrainMaker make_terrain_;
  MeetingRules rules_;
  std::function<void(const std::string&)> warn_;
  std::vector<std::unique_ptr<Scan>> scans_;
  nlohmann::json json_;
  DrawSpan span_;
  std::unique_ptr<DrawSeries> series_;
  std::size_t loaded_ = 0;
};

/// Adds draws until the span, the rule or an interrupt ends the run, and keeps the state.
class DrawLoop {
 public:
  DrawLoop(ScanSequence& scans, const DrawSpan& span, std::optional<Sprt> sprt, const DrawsState& state,
           const DrawsOutput& output)
      : scans_(scans), span_(span), sprt_(std::move(sprt)), state_(state), output_(output) {}

  void run(Draws& draws, const DeferredInterrupts& interrupts, const ProgressCallback& progress) {
    if (sprt_)
      for (std::int64_t row = 0; row < draws.table.size(); ++row) sprt_->add(is_success(draws.table, row));
    saved_s_ = output_.clock_s();
    const DrawsControl control{[&] { return !interrupts.requested(); },
                               [&] { return take(draws, interrupts, progress); }, output_.log};
    while (!is_done(draws) && !interrupts.requested()) {
      const std::int64_t row = draws.table.end();
      scans_.of(row).run(draws, scans_.rows_from(row), control);
    }
    scans_.complete(draws);
    if (!interrupts.requested()) report(progress, 1);
  }

  /// Keeps the draws of an interrupted run.
  void keep(const Draws& draws) {
    if (draws.table.size() == 0) return;
    state_.save(draws, scans_.crs_wkt());
    output_.warn(std::to_string(draws.table.size()) + " of " + std::to_string(span_.end - span_.first) +
                 " draws are kept; run the same command again to continue");
  }

  [[nodiscard]] std::optional<SprtState> sprt_state() const {
    return sprt_ ? std::optional(sprt_->state()) : std::nullopt;
  }

 private:
  /// Called after each draw. Returns whether the run takes another one.
  bool take(Draws& draws, const DeferredInterrupts& interrupts, const ProgressCallback& progress) {
    if (sprt_) sprt_->add(is_success(draws.table, draws.table.size() - 1));
    const std::vector<std::int8_t>& pass = draws.table.pass;
    output_.note(std::to_string(std::ranges::count(pass, 1)) + " of " + std::to_string(pass.size()) +
                 " pass");
    report(progress, static_cast<double>(draws.table.end() - span_.first) /
                         static_cast<double>(span_.end - span_.first));
    if (is_done(draws)) return false;
    const std::int64_t more = span_.end - draws.table.end();
    if (std::exchange(is_first_, false)) {
      const double minutes = (output_.clock_s() - saved_s_) * static_cast<double>(more) / 60;
      const double disk_mb = draws.maps ? kDisk_MB * static_cast<double>(draws.maps->spec().size()) : 1;
      output_.log("about " + number_text(std::ceil(minutes)) + " min and " + number_text(std::ceil(disk_mb)) +
                  " MB of disk for up to " + std::to_string(more) + " more draws, by the first");
    }
    if (output_.clock_s() - saved_s_ < kStateInterval_s || interrupts.requested()) return true;
    scans_.complete(draws);
    state_.save(draws, scans_.crs_wkt());
    saved_s_ = output_.clock_s();
    return true;
  }

  /// The draws that the sequential test counts.
  [[nodiscard]] bool is_success(const DrawTable& table, std::int64_t row) const {
    const auto at = static_cast<std::size_t>(row);
    return scans_.config().tests_landing() ? find_metric(table, kLandingSafe)->values[at] == 1
                                           : table.pass[at] == 1;
  }

  [[nodiscard]] bool is_done(const Draws& draws) const {
    return draws.table.end() >= span_.end || (sprt_ && sprt_->state() != SprtState::running);
  }

  ScanSequence& scans_;
  DrawSpan span_;
  std::optional<Sprt> sprt_;
  const DrawsState& state_;
  const DrawsOutput& output_;
  bool is_first_ = true;
  double saved_s_ = 0;  ///< when the last state was written
};

/// Landings beyond the terrain are not safe, whatever is there.
void warn_of_off_terrain(const nlohmann::ordered_json& verdict, const DrawsOutput& output) {
  if (!verdict.contains("landing")) return;
  const nlohmann::ordered_json& landing = verdict.at("landing");
  for (const auto& [arm, what] : {std::pair{"lidar", "with"}, std::pair{"blind", "without"}})
    if (const auto count = landing.at("off_terrain").at(arm).get<std::int64_t>(); count > 0)
      output.warn(std::to_string(count) + " of " +
                  std::to_string(landing.at("safe").at("draws").get<std::int64_t>()) + " landings " + what +
                  " a lidar are not over the terrain and count as not safe; make the terrain larger");
}

}  // namespace

DrawsSummary run_draws(const DrawsSources& sources, const std::optional<DrawSpan>& part, DrawsOutput output) {
  std::optional<NumberTable> samples;
  if (!sources.samples.empty()) {
    samples = read_number_table(sources.samples, {.all = true});
    output.provenance.add_input("samples", content_id(sources.samples), nlohmann::json::array());
  }
  ScanSequence scans(sources, output.config, output.config_name, samples ? &*samples : nullptr, output.warn);
  for (const std::string& warning : scans.config().warnings()) output.warn(warning);
  output.provenance.config = scans.json();
  cut_paths(output.provenance.config);
  const DrawSpan span = scans.checked_span(part);
  if (const auto why = scans.config().why_not_judged()) output.warn(scans.config().name() + ": " + *why);
  output.phase("read",
               [&](const ProgressCallback& progress) { scans.check(span, output.provenance, progress); });
  const DrawsState state(output.file.path, output.provenance, span.first);
  if (span.first != 0 || span.end != scans.row_count())
    output.provenance.options.update(part_options(span.first, span.end));
  LandfallFileWriter file(output.file, "draws", output.provenance);
  std::optional<Draws> kept = state.load(output.warn);
  Draws draws = kept ? *std::move(kept) : scans.of(span.first).empty(span.first);
  const std::int64_t done = draws.table.size();
  if (done > 0) output.log("resumes after " + std::to_string(done) + " draws");
  std::optional<Sprt> sprt;
  if (scans.config().sprt()) sprt.emplace(*scans.config().sprt());
  DrawLoop loop(scans, span, std::move(sprt), state, output);
  const double began_s = output.clock_s();
  {
    const DeferredInterrupts interrupts;
    output.phase("draw", [&](const ProgressCallback& progress) { loop.run(draws, interrupts, progress); });
    if (interrupts.requested()) loop.keep(draws);
  }
  DrawsSummary result{verdict_json(draws.table, loop.sprt_state()),
                      static_cast<double>(draws.table.size() - done) / (output.clock_s() - began_s)};
  warn_of_off_terrain(result.verdict, output);
  const std::string crs_wkt = scans.crs_wkt();
  scans.clear();  // its memory is not needed to write the maps
  output.phase("write", [&](const ProgressCallback&) {
    if (output.report) output.report(draws, result.verdict, output.provenance);
    write_draws(file, draws, result.verdict, crs_wkt);
  });
  state.remove();
  return result;
}

}  // namespace landfall
