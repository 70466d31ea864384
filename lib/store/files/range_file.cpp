// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/range_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/returns/columns.h"
#include "chain/lidar/simulation/echo_columns.h"
#include "store/files/crs.h"

// A redraw's file equals the traced run's, byte for byte, including its compression: the file does not
// depend on the way a scan was made. A faster and weaker compression for redraws alone would bring them
// closer to a third of the tracing time, but break this; using it for both saves at least twice as much in
// a traced run, which has twice as many columns to compress.

namespace landfall {
namespace {

std::int64_t pulse_of(const LaterEcho& echo) { return echo.where.pulse; }

constexpr const char* kRange = name_of(&PointColumns::range_true);
constexpr const char* kPixel = name_of(&PointColumns::pixel);
constexpr const char* kBegin = name_of(&PulseColumns::point_begin);
constexpr const char* kCount = name_of(&PulseColumns::point_count);

std::vector<std::string> echo_columns() {
  std::vector<std::string> names;
  for (const EchoMember& part : kEchoMembers) names.emplace_back(name_of(part.first));
  return names;
}

}  // namespace

LaterEchoReader::LaterEchoReader(const LandfallFileReader& scan)
    : scan_(scan),
      table_(scan.root(), kEchoGroup, scan.name()),
      row_count_(table_.row_count(name_of(&EchoColumns::pulse))) {}

bool LaterEchoReader::is_next(const PulsePixel& where, std::size_t pixel_count) const {
  return where.pulse >= 0 && where.number >= 1 && where.pixel >= 0 &&
         where.pixel < static_cast<std::int64_t>(pixel_count) && (!last_ || *last_ < where);
}

void LaterEchoReader::read_rows(std::size_t pixel_count) {
  held_.erase(held_.begin(), held_.begin() + given_);
  given_ = 0;
  EchoColumns rows;
  const std::size_t count = std::min(kTableChunkRows, row_count_ - next_row_);
  for_each_column(kEchoColumns, [&](const auto& column) {
    (rows.*column.rows).resize(count);
    table_.read(column.name, next_row_, std::span(rows.*column.rows));
  });
  for (std::size_t i = 0; i < count; ++i, ++next_row_) {
    const PulsePixel where{rows.pulse[i], rows.pixel[i], rows.number[i]};
    if (!is_next(where, pixel_count))
      scan_.fail("/" + std::string(kEchoGroup) + " row " + std::to_string(next_row_) +
                 " is not the next echo of a pixel");
    LaterEcho& echo = held_.emplace_back(LaterEcho{where, {}});
    for (const EchoMember& part : kEchoMembers) echo.echo.*part.member = (rows.*part.later)[i];
    last_ = where;
  }
}

std::vector<LaterEcho> LaterEchoReader::read(PulseSpan pulses, std::size_t pixel_count) {
  if (pulses.first < given_pulses_) {
    held_.clear();
    given_ = 0;
    last_.reset();
    next_row_ = 0;
  }
  given_pulses_ = pulses.first + pulses.count;
  while (next_row_ < row_count_ && (held_.empty() || pulse_of(held_.back()) < given_pulses_))
    read_rows(pixel_count);
  const auto end_before = [&](std::int64_t pulse) {
    return std::ranges::lower_bound(held_.begin() + given_, held_.end(), pulse, {}, pulse_of);
  };
  const auto first = end_before(pulses.first);
  const auto end = end_before(given_pulses_);
  given_ = end - held_.begin();
  return {first, end};
}

RangeFile::RangeFile(const std::filesystem::path& path)
    : file_(path, {"scan"}),
      points_(file_.root(), "points", file_.name()),
      pulses_(file_.root(), "pulses", file_.name()),
      range_and_pixel_(points_, {kRange, kPixel}),
      begin_and_count_(pulses_, {kBegin, kCount}),
      pulse_count_(pulses_.row_count(kBegin)) {
  if (points_.has(name_of(&PointColumns::echo_range))) echoes_.emplace(points_, echo_columns());
  if (h5::exists(file_.root(), kEchoGroup)) later_echoes_.emplace(file_);
  if (pulse_count_ != pulses_.row_count(kCount))
    file_.fail("/pulses/point_begin and /pulses/point_count differ in length");
  if (points_.row_count(kRange) != points_.row_count(kPixel))
    file_.fail("/points/range_true and /points/pixel differ in length");
}

bool RangeFile::keeps_misses() const {
  return h5::read_number_attribute(points_.group(), "misses_kept").value_or(0) == 1;
}

bool RangeFile::has_several_returns() const { return points_.has(name_of(&PointColumns::return_number)); }

bool RangeFile::has_exact_ranges() const { return points_.element_size(kRange) == sizeof(double); }

TerrainIdentity RangeFile::terrain() const {
  TerrainIdentity terrain{read_crs(file_)};
  if (file_.chain().empty()) return terrain;
  for (const nlohmann::json& input : file_.chain().back().value("inputs", nlohmann::json::array()))
    if (input.value("role", "") == "terrain") terrain.file_id = input.value("file_id", "");
  terrain.chain = file_.chain();
  terrain.chain.erase(terrain.chain.size() - 1);
  return terrain;
}

RangeFile::PulseRows RangeFile::rows_of(PulseSpan pulses, std::int64_t max_rows) {
  const auto first = static_cast<std::size_t>(pulses.first);
  const auto count = static_cast<std::size_t>(pulses.count);
  if (first + count > pulse_count_)
    file_.fail("has " + std::to_string(pulse_count_) + " pulses, this scan more");
  PulseRows rows{std::vector<std::int64_t>(count), std::vector<std::int32_t>(count)};
  const std::array<ColumnTarget, 2> targets = {std::span(rows.begin), std::span(rows.count)};
  begin_and_count_.read(first, targets);
  rows.total = rows.begin.back() + rows.count.back() - rows.begin.front();
  if (rows.begin.front() < 0 || rows.total < 0 || rows.total > max_rows)
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
  std::vector<std::vector<double>> columns(kEchoMembers.size(), std::vector<double>(count));
  std::vector<ColumnTarget> targets;
  for (std::vector<double>& column : columns) targets.emplace_back(std::span(column));
  echoes_->read(first_row, targets);
  std::vector<Echo> echoes(count);
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < count; ++i) echoes[i].*kEchoMembers[c].member = columns[c][i];
  return echoes;
}

RecordedRanges RangeFile::read(PulseSpan pulses, std::size_t pixel_count) {
  const auto max_rows = pulses.count * static_cast<std::int64_t>(pixel_count);
  const PulseRows rows = rows_of(pulses, max_rows);
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
