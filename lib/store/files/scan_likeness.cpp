// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/scan_likeness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "base/core/error.h"
#include "base/numerics/non_finite.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "chain/likeness/likeness.h"
#include "store/files/column_specs.h"
#include "store/files/field_json.h"
#include "store/files/place_json.h"
#include "store/files/scan_gridding.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;
using Kind = ReturnQuantity::Kind;

constexpr std::size_t kMaxReturns = std::size_t{1} << 20U;

/// A rectangle of the frame of A.
struct SeenExtent {
  std::array<double, 2> low{kInfinity, kInfinity}, high{-kInfinity, -kInfinity};

  void add(double x, double y) {
    low = {std::min(low[0], x), std::min(low[1], y)};
    high = {std::max(high[0], x), std::max(high[1], y)};
  }
  [[nodiscard]] bool contains(double x, double y) const {
    return x >= low[0] && x <= high[0] && y >= low[1] && y <= high[1];
  }
};

/// The columns that landfall-info compares where both scans have them.
const std::vector<ReturnQuantity>& column_quantities() {
  static const std::vector<ReturnQuantity> all = {
      {.name = name_of(&PointColumns::range_measured), .unit = "m"},
      {.name = name_of(&PointColumns::intensity), .kind = Kind::relative},
      {.name = name_of(&PointColumns::return_number)},
      {.name = name_of(&PointColumns::echo_width), .unit = "m"},
      {.name = name_of(&PointColumns::echo_peak)}};
  return all;
}

/// The returns of a scan as they are compared.
class ComparedScanReader {
 public:
  ComparedScanReader(ScanReader& scan, Placement placement)
      : scan_(scan),
        points_(scan_.file().root(), "points", scan_.file().name()),
        placement_(std::move(placement)) {
    for (const ReturnQuantity& quantity : column_quantities())
      if (points_.has(quantity.name)) quantities_.push_back(quantity);
    if (scan_.has_truth()) read_lidar_positions();
  }

  /// The returns in an extent, in the order of their times; the first kMaxReturns if there are more.
  [[nodiscard]] ComparedScan read(const SeenExtent& within) {
    found_ = {};
    found_.quantities = quantities_;
    if (scan_.has_truth())
      found_.quantities.push_back({.name = "range_error", .unit = "m", .kind = Kind::error});
    seen_ = {};
    count_ = 0;
    for (std::size_t begin = 0; begin < scan_.row_count(); begin += kBatchRows)
      read_batch(begin, std::min(kBatchRows, scan_.row_count() - begin), within);
    if (!scan_.has_times()) found_.t.clear();
    sort_by_time();
    return std::move(found_);
  }

  /// The extent of all returns that the last read() saw, and how many lie in the one that was asked for.
  [[nodiscard]] const SeenExtent& seen() const { return seen_; }
  [[nodiscard]] std::size_t count() const { return count_; }

 private:
  void read_lidar_positions() {
    const TableReader pulses(scan_.file().root(), "pulses", scan_.file().name());
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lidar_.at(axis).resize(scan_.pulse_times_s().size());
      pulses.read(std::array{"px_est", "py_est", "pz_est"}.at(axis), 0, std::span(lidar_.at(axis)));
    }
    placement_.to_first(lidar_[0], lidar_[1]);
    placement_.raise(lidar_[2]);
  }

  void read_batch(std::size_t begin, std::size_t count, const SeenExtent& within) {
    scan_.read(begin, count, batch_);
    placement_.to_first(batch_.columns.x_est, batch_.columns.y_est);
    placement_.raise(batch_.columns.z_est);
    std::vector<std::int8_t> status(count);
    points_.read(name_of(&PointColumns::status), begin, std::span(status));
    std::vector<std::int32_t> pulse(scan_.has_truth() ? count : 0);
    if (scan_.has_truth()) points_.read(name_of(&PointColumns::pulse), begin, std::span(pulse));
    std::vector<std::vector<double>> columns;
    const auto read_column = [&](const std::string& name) {
      points_.read(name, begin, std::span(columns.emplace_back(count)));
    };
    for (const ReturnQuantity& quantity : quantities_) read_column(quantity.name);
    if (scan_.has_truth()) read_column(name_of(&PointColumns::range_true));
    std::size_t next = 0;  // in batch_, which has returns alone
    for (std::size_t row = 0; row < count; ++row) {
      if (!is_return(PointStatus{status[row]})) continue;
      if (keep(next++, within)) keep_columns(row, columns, pulse);
    }
  }

  /// Whether a return of the batch is kept, and its position and time are.
  bool keep(std::size_t i, const SeenExtent& within) {
    const double x = batch_.columns.x_est[i], y = batch_.columns.y_est[i];
    if (std::isnan(x)) return false;  // no place in the frame of A
    seen_.add(x, y);
    if (!within.contains(x, y) || ++count_ > kMaxReturns) return false;
    found_.x.push_back(x);
    found_.y.push_back(y);
    found_.z.push_back(batch_.columns.z_est[i]);
    found_.t.push_back(batch_.t[i]);
    return true;
  }

  void keep_columns(std::size_t row, const std::vector<std::vector<double>>& columns,
                    const std::vector<std::int32_t>& pulse) {
    for (std::size_t q = 0; q < quantities_.size(); ++q) {
      found_.quantities[q].values.push_back(columns[q][row]);
      if (quantities_[q].name == name_of(&PointColumns::return_number))
        found_.number.push_back(static_cast<std::int8_t>(columns[q][row]));
    }
    if (!scan_.has_truth()) return;
    found_.quantities.back().values.push_back(columns.front()[row] - columns.back()[row]);
    const auto of_pulse = static_cast<std::size_t>(pulse[row]);
    found_.px.push_back(lidar_[0][of_pulse]);
    found_.py.push_back(lidar_[1][of_pulse]);
    found_.pz.push_back(lidar_[2][of_pulse]);
  }

  /// Imported points may have any order.
  void sort_by_time() {
    std::vector<std::size_t> order(found_.t.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, {}, [&](std::size_t i) { return found_.t[i]; });
    if (std::ranges::is_sorted(order)) return;
    const auto sort = [&](auto& values) {
      auto sorted = values;
      for (std::size_t i = 0; i < values.size(); ++i) sorted[i] = values[order[i]];
      values = std::move(sorted);
    };
    for (auto* const values : {&found_.x, &found_.y, &found_.z, &found_.px, &found_.py, &found_.pz})
      sort(*values);
    sort(found_.number);
    for (ReturnQuantity& quantity : found_.quantities) sort(quantity.values);
    sort(found_.t);
  }

  ScanReader& scan_;
  TableReader points_;
  Placement placement_;
  std::vector<ReturnQuantity> quantities_;  ///< those that the file has
  std::array<std::vector<double>, 3> lidar_;
  ScanPoints batch_;
  ComparedScan found_;
  SeenExtent seen_;
  std::size_t count_ = 0;
};

/// Both scans, in one frame, in the extent that is compared.
struct ComparedScans {
  ComparedScan a, b;
  std::string note;  ///< the extent, if it is not that of both
};

ComparedScans read_pair(ComparedScanReader& a, ComparedScanReader& b) {
  const SeenExtent everywhere{{-kInfinity, -kInfinity}, {kInfinity, kInfinity}};
  ComparedScans pair{a.read(everywhere), b.read(everywhere), ""};
  const std::size_t total = std::max(a.count(), b.count());
  std::array<double, 2> middle{};
  double half = kInfinity;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const double low = std::max(a.seen().low.at(axis), b.seen().low.at(axis));
    const double high = std::min(a.seen().high.at(axis), b.seen().high.at(axis));
    if (low > high) throw UsageError("the scans have no ground in common");
    middle.at(axis) = (low + high) / 2;
    half = std::min(half, (high - low) / 2);
  }
  while (std::max(a.count(), b.count()) > kMaxReturns) {
    half *= 0.9 *
            std::sqrt(static_cast<double>(kMaxReturns) / static_cast<double>(std::max(a.count(), b.count())));
    const SeenExtent square{{middle[0] - half, middle[1] - half}, {middle[0] + half, middle[1] + half}};
    pair = {a.read(square), b.read(square),
            "of at most " + grouped(static_cast<std::int64_t>(total)) + " returns those within " +
                short_number(half) + " m of x " + short_number(middle[0]) + " m, y " +
                short_number(middle[1]) + " m are compared"};
  }
  return pair;
}

OrderedJson statistic_json(const LikenessStatistic& s) {
  const auto differs = s.differs();
  return {{"name", s.name},
          {"unit", s.unit.empty() ? "1" : s.unit},
          {"a", finite_json(s.a)},
          {"b", finite_json(s.b)},
          {"distance", finite_json(s.distance)},
          {"distance_unit", s.distance_unit.empty() ? "1" : s.distance_unit},
          {"chance", finite_json(s.chance)},
          {"p", finite_json(s.p)},
          {"differs", differs ? OrderedJson(*differs) : OrderedJson()}};
}

OrderedJson likeness_json(const Likeness& likeness, const ComparedScans& pair) {
  OrderedJson json = {{"returns", {{"a", pair.a.x.size()}, {"b", pair.b.x.size()}}},
                      {"posting_m", likeness.posting_m},
                      {"bins", likeness.bins},
                      {"block_overlap_frac", likeness.block_overlap},
                      {"exchanges", kExchanges},
                      {"statistics", OrderedJson::array()},
                      {"not_in_both", likeness.not_in_both},
                      {"covered_frac", {{"a", likeness.covered_a}, {"b", likeness.covered_b}}}};
  for (const LikenessStatistic& statistic : likeness.statistics)
    json["statistics"].push_back(statistic_json(statistic));
  const SurfaceDifference& s = likeness.surface;
  json["surface"] = {{"bins", s.bins},
                     {"median_m", finite_json(s.median_m)},
                     {"nmad_m", finite_json(s.nmad_m)},
                     {"p95_m", finite_json(s.p95_m)},
                     {"shift_m", {finite_json(s.shift_x_m), finite_json(s.shift_y_m)}},
                     {"tilt_rad", {finite_json(s.tilt_x_rad), finite_json(s.tilt_y_rad)}}};
  return json;
}

std::string with_unit(double value, const std::string& unit) {
  return std::isnan(value) ? "unknown" : short_number(value) + (unit.empty() ? "" : " " + unit);
}

/// "2.13 m -> 4.21 m; distance 0.61, chance 0.043: beyond chance".
std::string point_text(const LikenessStatistic& s) {
  std::string text;
  if (!std::isnan(s.a) || !std::isnan(s.b))
    text = with_unit(s.a, s.unit) + " -> " + with_unit(s.b, s.unit) + "; ";
  text += "distance " + with_unit(s.distance, s.distance_unit);
  if (!s.differs()) return text;
  return text + ", chance " + with_unit(s.chance, s.distance_unit) + (*s.differs() ? ": beyond chance" : "");
}

OrderedJson answer_json(const Likeness& likeness, const std::string& note) {
  std::vector<std::string> beyond, within;
  OrderedJson points = OrderedJson::array();
  for (const LikenessStatistic& s : likeness.statistics) {
    const auto differs = s.differs();
    if (differs) (*differs ? beyond : within).push_back(s.name);
    points.push_back({{"name", s.name},
                      {"change", !differs   ? "unknown"
                                 : *differs ? "differs"
                                            : "alike"},
                      {"text", point_text(s)}});
  }
  const auto list = [](const std::vector<std::string>& names) {
    return names.empty() ? "nothing" : joined(names, ", ");
  };
  OrderedJson notes = {"bins of " + number_text(likeness.posting_m) +
                       " m; chance: the second largest distance of " + std::to_string(kExchanges) +
                       " exchanges of random blocks of time, beyond which p is at most 0.01"};
  if (likeness.block_overlap < 0.5)
    notes.push_back("blocks of equal time see other ground (" + percent_text(likeness.block_overlap) +
                    " in common): statistics of places have no chance level");
  if (!likeness.not_in_both.empty())
    notes.push_back("in one scan alone: " + joined(likeness.not_in_both, ", "));
  if (!note.empty()) notes.push_back(note);
  return {{"conclusion", !beyond.empty()  ? "differs"
                         : within.empty() ? "unknown"
                                          : "alike"},
          {"sentence",
           "B differs from A beyond chance in " + list(beyond) + "; within chance in " + list(within)},
          {"points", std::move(points)},
          {"notes", std::move(notes)}};
}

}  // namespace

void add_likeness(OrderedJson& comparison, const std::filesystem::path& a, const std::filesystem::path& b,
                  const ComparisonRequest& request, const ProgressCallback& progress) {
  Provenance unused;
  const Scans scans = open_scans({a.string(), b.string()}, unused);
  const Meeting meeting =
      meeting_of(meeting_kind("scans"), sited(*scans[0]), sited(*scans[1]), request.rules);
  comparison["a"]["place"] = place_json(scans[0]->crs_wkt());
  comparison["b"]["place"] = place_json(scans[1]->crs_wkt());
  comparison["placement"] = {{"shift_m", meeting.placement.shift_m()}, {"said", meeting.said}};
  if (!meeting.refusal.empty()) comparison["not_compared"] = meeting.refusal;
  if (!meeting.refusal.empty() || !request.statistics) return;
  try {
    ComparedScanReader reader_a(*scans[0], {}), reader_b(*scans[1], meeting.placement);
    const ComparedScans pair = read_pair(reader_a, reader_b);
    const Likeness likeness = likeness_of(pair.a, pair.b, static_cast<bool>(request.on_layer), progress);
    comparison["likeness"] = likeness_json(likeness, pair);
    comparison["answer"] = answer_json(likeness, pair.note);
    if (!request.on_layer) return;
    request.on_layer("dem", {"count", h5::Type::int32, "1", ""}, likeness.counts[0], likeness.counts[1]);
    request.on_layer("dem", {"z_est", h5::Type::float64, "m", ""}, likeness.elevations[0],
                     likeness.elevations[1]);
  } catch (const UsageError& error) {
    comparison["not_compared"] = error.what();
  }
}

}  // namespace landfall
