// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/range_file.h"

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "base/abbreviated.h"
#include "base/error.h"
#include "files/crs.h"
#include "returns/columns.h"

namespace landfall {
namespace {

constexpr const char* kRange = name_of(&PointColumns::range_true);
constexpr const char* kPixel = name_of(&PointColumns::pixel);
constexpr std::array kFirstEcho = {&PointColumns::echo_signal, &PointColumns::echo_peak,
                                   &PointColumns::echo_edge, &PointColumns::echo_width,
                                   &PointColumns::echo_range};
constexpr std::array kEchoMembers = {&Echo::signal_pe, &Echo::peak, &Echo::edge_m, &Echo::width_m,
                                     &Echo::range_m};
static_assert(kFirstEcho.size() == kEchoMembers.size());

// What --ranges-from must find unchanged.
constexpr std::array kRays = {"/detector", "/laser", "/scanner", "/mount", "/trajectory"};
constexpr std::array kTruePointing = {"/pointing_error/misalignment_rpy_rad",
                                      "/pointing_error/jitter_sigma_rad", "/pointing_error/jitter_time_s",
                                      "/pointing_error/mirror_time_bias_s",
                                      "/pointing_error/mirror_time_sigma_s"};
/// Shape the echoes or choose the one that is reported.
constexpr std::array kEcho = {"/receiver/type",     "/receiver/pulse_fwhm_s", "/receiver/threshold_pe",
                              "/receiver/fraction", "/receiver/returns",      "/receiver/max_returns"};
constexpr std::array kSignal = {"/beam", "/surface", "/link"};

constexpr const char* kBegin = name_of(&PulseColumns::point_begin);
constexpr const char* kCount = name_of(&PulseColumns::point_count);

std::vector<std::string> names_of(const auto& members) {
  std::vector<std::string> names;
  for (const auto member : members) names.emplace_back(name_of(member));
  return names;
}

/// The value at a path such as /noise/dropout_frac, null if it does not exist: a foreign file's configuration
/// may have any structure.
nlohmann::json value_at(const nlohmann::json& config, const std::string& path) {
  const nlohmann::json::json_pointer where(path);
  return config.contains(where) ? config.at(where) : nlohmann::json();
}

/// A key whose values differ; a value is null where there is none.
struct Difference {
  std::string where;  ///< "/detector/rows"
  nlohmann::json theirs;
  nlohmann::json ours;

  [[nodiscard]] std::string text() const {
    const auto shown = [](const nlohmann::json& value) {
      return value.is_null() ? std::string("none") : abbreviated(value.dump());
    };
    return where + " differs: " + shown(theirs) + " in the scan, " + shown(ours) + " in this configuration";
  }
};

std::optional<Difference> first_difference(const nlohmann::json& theirs, const nlohmann::json& ours,
                                           const std::string& where) {
  if (theirs == ours) return std::nullopt;
  if (!theirs.is_object() || !ours.is_object()) return Difference{where, theirs, ours};
  for (const auto& [key, value] : theirs.items())
    if (auto inner = first_difference(value, ours.value(key, nlohmann::json()), where + "/" + key))
      return inner;
  for (const auto& [key, value] : ours.items())
    if (!theirs.contains(key)) return Difference{where + "/" + key, nullptr, value};
  return std::nullopt;
}

/// What differs first below these paths; empty if nothing does.
std::string difference_text(const nlohmann::json& theirs, const nlohmann::json& ours,
                            std::span<const char* const> paths) {
  for (const char* const where : paths)
    if (const auto found = first_difference(value_at(theirs, where), value_at(ours, where), where))
      return found->text();
  return {};
}

bool has_receiver(const nlohmann::json& config) {
  const nlohmann::json type = value_at(config, "/receiver/type");
  return !type.is_null() && type != "none";
}

/// True if the configuration drops no pixel that hit.
bool loses_nothing(const nlohmann::json& config) {
  const nlohmann::json noise = config.value("noise", nlohmann::json::object());
  const auto is_zero = [&](const char* key) {
    return noise.is_object() && noise.contains(key) && noise[key] == 0;
  };
  return is_zero("dropout_frac") && is_zero("dead_pixel_frac") && !has_receiver(config);
}

bool has_false_returns(const nlohmann::json& config) {
  const nlohmann::json share = value_at(config, "/noise/false_return_frac");
  return !share.is_null() && share != 0;
}

/// The key with a nonzero value that makes the true beams depend on the seed; empty if there is none.
std::string seed_moves_beams_by(const nlohmann::json& config) {
  const nlohmann::json::json_pointer jitter("/pointing_error/jitter_sigma_rad");
  const nlohmann::json sigma = config.value(jitter, nlohmann::json(0));
  if (sigma != 0 && sigma != nlohmann::json({0, 0})) return jitter.to_string();
  for (const char* const where : {"/pointing_error/mirror_time_sigma_s", "/scanner/facet_tilt_sigma_rad"})
    if (config.value(nlohmann::json::json_pointer(where), 0.0) != 0) return where;
  // The encoder error of an fsm affects only the estimate, but that of prisms affects the true beam.
  const nlohmann::json::json_pointer encoder("/scanner/encoder_sigma_rad");
  if (config.value(nlohmann::json::json_pointer("/scanner/type"), "") == "risley" &&
      config.value(encoder, 0.0) != 0)
    return encoder.to_string();
  return {};
}

/// The reason why the lidars' true pointing differs; empty if it does not.
std::string turned_beams_differ(const nlohmann::json& theirs, const nlohmann::json& ours) {
  if (std::string text = difference_text(theirs, ours, kTruePointing); !text.empty()) return text;
  const std::string key = seed_moves_beams_by(ours);
  if (key.empty()) return {};
  const std::string text = difference_text(theirs, ours, std::array{"/seed"});
  return text.empty() ? "" : text + "; the true beams follow it by " + key;
}

/// The input files that determine the true ranges.
nlohmann::json inputs_of_truth(const nlohmann::json& inputs) {
  nlohmann::json kept = nlohmann::json::array();
  for (const nlohmann::json& input : inputs) {
    const std::string role = input.value("role", "");
    if (role != "navigation" && role != "offsets") kept.push_back(input);
  }
  return kept;
}

}  // namespace

RangeFile::RangeFile(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      pulses_(file_.root(), "pulses", file_.name()),
      range_and_pixel_(points_, {kRange, kPixel}),
      begin_and_count_(pulses_, {kBegin, kCount}),
      pulse_count_(pulses_.row_count(kBegin)) {
  if (points_.has(name_of(&PointColumns::echo_range))) echoes_.emplace(points_, names_of(kFirstEcho));
  if (h5::exists(file_.root(), kEchoGroup)) later_echoes_.emplace(file_);
  if (pulse_count_ != pulses_.row_count(kCount))
    file_.fail("/pulses/point_begin and /pulses/point_count differ in length");
  if (points_.row_count(kRange) != points_.row_count(kPixel))
    file_.fail("/points/range_true and /points/pixel differ in length");
}

void RangeFile::refuse(const std::string& option, const std::string& why) const {
  throw UsageError(option + file_.name() + ": " + why);
}

void RangeFile::require_match(const Provenance& provenance, const std::string& option) const {
  const nlohmann::json& theirs = file_.config();
  if (!theirs.is_object() || file_.chain().empty()) refuse(option, "does not say how it was made");
  const nlohmann::json& step = file_.chain().back();
  if (step.value("version", "") != program_version())
    refuse(option, "made by version " + step.value("version", "?") + ", this is " + program_version());
  require_same(provenance.config, kRays, option);
  const std::string turned = turned_beams_differ(theirs, provenance.config);
  if (!turned.empty()) refuse(option, turned);
  require_same_receiver(provenance.config, option);
  if (inputs_of_truth(step.value("inputs", nlohmann::json())) !=
      inputs_of_truth(provenance.as_step().at("inputs")))
    refuse(option, "its terrain or a table (trajectory, pixels, ...) differs from this run's");
  require_complete_ranges(option);
}

void RangeFile::require_same(const nlohmann::json& config, std::span<const char* const> paths,
                             const std::string& option) const {
  const std::string text = difference_text(file_.config(), config, paths);
  if (!text.empty()) refuse(option, text);
}

void RangeFile::require_same_receiver(const nlohmann::json& config, const std::string& option) const {
  if (points_.has(name_of(&PointColumns::return_number)))
    refuse(option,
           "has several returns per pixel (/receiver/returns all), of which no single echo can be drawn "
           "anew");
  require_same(config, kEcho, option);
  if (!has_receiver(config)) return;
  require_same(config, kSignal, option);
  if (config["receiver"]["type"] == "geiger")
    refuse(option, "a Geiger-mode receiver needs the whole waveforms, which no scan keeps; trace the rays");
  const bool lacks_later = config["receiver"].value("returns", "first") == "first" && !later_echoes_;
  if (!keeps_echoes() || lacks_later)
    refuse(option, "does not hold the echoes that its receiver saw; make it with --keep-echoes");
}

void RangeFile::require_complete_ranges(const std::string& option) const {
  if (!loses_nothing(file_.config()) && !misses_kept())
    refuse(option,
           "the ranges of its dropped, dead and undetected pixels are missing; make it with "
           "--keep-misses, or with /noise/dropout_frac and /noise/dead_pixel_frac 0 and no receiver");
  if (points_.element_size(kRange) != sizeof(double))
    refuse(option, "its ranges are in single precision (--float32)");
}

bool RangeFile::misses_kept() const {
  return h5::read_number_attribute(points_.group(), "misses_kept").value_or(0) == 1;
}

bool RangeFile::has_rows_of(const nlohmann::json& config, bool keep_misses) const {
  if (keep_misses != misses_kept()) return false;
  if (has_false_returns(config) || has_false_returns(file_.config())) return false;
  return keep_misses || (loses_nothing(config) && loses_nothing(file_.config()));
}

TerrainIdentity RangeFile::terrain() const {
  TerrainIdentity terrain{read_crs(file_.root())};
  if (file_.chain().empty()) return terrain;
  for (const nlohmann::json& input : file_.chain().back().value("inputs", nlohmann::json::array()))
    if (input.value("role", "") == "terrain") terrain.file_id = input.value("file_id", "");
  terrain.chain = file_.chain();
  terrain.chain.erase(terrain.chain.size() - 1);
  return terrain;
}

RangeFile::PulseRows RangeFile::rows_of(PulseSpan pulses, std::int64_t most) {
  const auto first = static_cast<std::size_t>(pulses.first);
  const auto count = static_cast<std::size_t>(pulses.count);
  if (first + count > pulse_count_)
    file_.fail("has " + std::to_string(pulse_count_) + " pulses, this scan more");
  PulseRows rows{std::vector<std::int64_t>(count), std::vector<std::int32_t>(count)};
  const std::array<ColumnTarget, 2> targets = {std::span(rows.begin), std::span(rows.count)};
  begin_and_count_.read(first, targets);
  rows.total = rows.begin.back() + rows.count.back() - rows.begin.front();
  if (rows.begin.front() < 0 || rows.total < 0 || rows.total > most)
    file_.fail("/pulses/point_begin does not fit /points");
  return rows;
}

bool RangeFile::PulseRows::hold_every_pixel(std::span<const std::int32_t> pixel,
                                            std::size_t pixel_count) const {
  const auto per_pulse = static_cast<std::int64_t>(pixel_count);
  for (std::size_t pulse = 0; pulse < count.size(); ++pulse)
    if (count[pulse] != per_pulse ||
        begin[pulse] != begin.front() + static_cast<std::int64_t>(pulse) * per_pulse)
      return false;
  bool in_order = true;  // no early exit, so that the loop runs at memory speed
  for (std::size_t first = 0; first < pixel.size(); first += pixel_count)
    for (std::size_t i = 0; i < pixel_count; ++i)
      in_order &= pixel[first + i] == static_cast<std::int32_t>(i);
  return in_order;
}

std::vector<Echo> RangeFile::read_echoes(std::size_t first_row, std::size_t count) {
  std::vector<std::vector<double>> columns(kFirstEcho.size(), std::vector<double>(count));
  std::vector<ColumnTarget> targets;
  for (std::vector<double>& column : columns) targets.emplace_back(std::span(column));
  echoes_->read(first_row, targets);
  std::vector<Echo> echoes(count);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < count; ++i) echoes[i].*kEchoMembers[c] = columns[c][i];
  return echoes;
}

RecordedRanges RangeFile::read(PulseSpan pulses, std::size_t pixel_count) {
  const auto most = pulses.count * static_cast<std::int64_t>(pixel_count);
  const PulseRows rows = rows_of(pulses, most);
  RecordedRanges found{std::vector<double>(static_cast<std::size_t>(rows.total))};
  std::vector<double>& range = found.ranges_m;
  std::vector<std::int32_t> pixel(range.size());
  const std::array<ColumnTarget, 2> targets = {std::span(range), std::span(pixel)};
  range_and_pixel_.read(static_cast<std::size_t>(rows.begin.front()), targets);
  for (std::size_t i = 0; i < range.size(); ++i)
    if (std::isinf(range[i]) || range[i] < 0)  // NaN is a miss
      file_.fail("/points/range_true[" + std::to_string(rows.begin.front() + static_cast<std::int64_t>(i)) +
                 "] is not a finite range >= 0");
  if (keeps_echoes()) found.echoes = read_echoes(static_cast<std::size_t>(rows.begin.front()), range.size());
  if (later_echoes_) found.later = later_echoes_->read(pulses, pixel_count);
  if (rows.hold_every_pixel(pixel, pixel_count)) return found;
  return by_pixel(rows, found, pixel, pixel_count);
}

RecordedRanges RangeFile::by_pixel(const PulseRows& rows, const RecordedRanges& found,
                                   std::span<const std::int32_t> pixel, std::size_t pixel_count) const {
  const std::int64_t first_row = rows.begin.front();
  RecordedRanges result{
      std::vector<double>(rows.count.size() * pixel_count, std::numeric_limits<double>::quiet_NaN())};
  if (!found.echoes.empty()) result.echoes.resize(result.ranges_m.size());
  result.later = found.later;
  for (std::size_t pulse = 0; pulse < rows.count.size(); ++pulse)
    for (std::int64_t i = 0; i < rows.count[pulse]; ++i) {
      const std::int64_t row = rows.begin[pulse] + i - first_row;
      if (row < 0 || row >= rows.total) file_.fail("/pulses/point_begin does not fit /points");
      const std::int32_t where = pixel[static_cast<std::size_t>(row)];
      if (where < 0 || static_cast<std::size_t>(where) >= pixel_count)
        file_.fail("/points/pixel[" + std::to_string(first_row + row) + "] is not a pixel of the detector");
      const std::size_t to = pulse * pixel_count + static_cast<std::size_t>(where);
      result.ranges_m[to] = found.ranges_m[static_cast<std::size_t>(row)];
      if (!found.echoes.empty()) result.echoes[to] = found.echoes[static_cast<std::size_t>(row)];
    }
  return result;
}

}  // namespace landfall
