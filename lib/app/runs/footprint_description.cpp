// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/runs/footprint_description.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/dictionary/tables/requirements.h"
#include "base/geometry/rotation_vector.h"
#include "base/numerics/non_finite.h"
#include "base/numerics/portable_math.h"
#include "base/returns/point_status.h"
#include "chain/evaluation/fail_flag.h"
#include "chain/evaluation/failure_cause.h"
#include "chain/evaluation/parameters.h"
#include "chain/hazards/measures.h"
#include "store/config/dem_config.h"
#include "store/files/bin_description.h"
#include "store/files/contents.h"
#include "store/files/field_json.h"
#include "store/files/grid_file.h"
#include "store/files/landfall_file.h"
#include "store/files/scan_file.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

using Described = nlohmann::ordered_json;

constexpr std::size_t kWorstBins = 5;
/// The window of the rules reaches this many footprints to either side, and at least so many bins.
constexpr std::int64_t kReachFootprints = 3;
constexpr std::int64_t kMinReachBins = 20;

/// The bins of a window about a bin of a map, cut at the border.
GridSpec window_of(const GridSpec& map, BinIndex bin, std::int64_t reach) {
  const BinIndex first{std::max<std::int64_t>(0, bin.row - reach),
                       std::max<std::int64_t>(0, bin.col - reach)};
  return part_of(map, first, std::min(map.rows, bin.row + reach + 1) - first.row,
                 std::min(map.cols, bin.col + reach + 1) - first.col);
}

double median(std::vector<double> values) {
  std::erase_if(values, [](double value) { return !std::isfinite(value); });
  if (values.empty()) return kNan;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return values.size() % 2 == 1 ? *middle : (*std::max_element(values.begin(), middle) + *middle) / 2;
}

const LandfallFileReader& with_layers(const LandfallFileReader& evaluation) {
  if (!has_grid(evaluation)) evaluation.fail("has no layers; run dem-eval without --metrics-only");
  return evaluation;
}

/// Ranges of the returns of one bin.
struct BinRanges {
  std::int64_t count = 0;
  double sum = 0, squares = 0;  ///< of measured less true ranges
};

/// The evaluation about a footprint.
class FootprintFile {
 public:
  FootprintFile(const std::filesystem::path& path, const SitePoint& point)
      : path_(path),
        file_(path, {"evaluation"}),
        grid_(with_layers(file_)),
        parameters_(evaluation_config(file_.config(), path.string())),
        bin_(bin_on_map(grid_.spec(), point, path.string())),
        footprint_(footprint_of(parameters_, grid_.spec().resolution_m)) {
    const std::int64_t reach =
        std::max(kMinReachBins, (2 * kReachFootprints + 1) * footprint_.half_bins() + kReachFootprints);
    window_ = window_of(grid_.spec(), bin_, reach);
    centre_ = {bin_.row + grid_.spec().first_row - window_.first_row,
               bin_.col + grid_.spec().first_col - window_.first_col};
    for (std::int64_t row = 0; row < window_.rows; ++row)
      for (std::int64_t col = 0; col < window_.cols; ++col)
        if (const std::int64_t up = row - centre_.row;
            std::abs(up) <= footprint_.half_bins() &&
            std::abs(col - centre_.col) <= footprint_.half_width(up))
          inside_.push_back({row, col});
  }

  [[nodiscard]] Described json(const FootprintSources& sources, const ProgressCallback& progress);

 private:
  [[nodiscard]] double value(const std::string& layer) const {
    return grid_.has(layer) ? grid_.read_part(layer, part_of(grid_.spec(), bin_, 1, 1)).values().front()
                            : kNan;
  }
  [[nodiscard]] Grid<double> part(const std::string& layer) const {
    return grid_.has(layer) ? grid_.read_part(layer, window_) : Grid<double>(window_, kNan);
  }
  [[nodiscard]] std::vector<double> of_footprint(const Grid<double>& layer) const {
    std::vector<double> values;
    for (const BinIndex bin : inside_) values.push_back(layer.at(bin));
    return values;
  }
  void read_dem(const std::filesystem::path& path);
  void read_scan(const std::filesystem::path& path, const ProgressCallback& progress);
  void read_ranges(const LandfallFileReader& scan, const Placement& placement,
                   const ProgressCallback& progress);
  void read_motion(const ScanReader& scan, const Placement& placement);
  [[nodiscard]] double largest_hole() const;
  void judge(Described& json);
  [[nodiscard]] Described bins_json(const FootprintSources& sources) const;
  [[nodiscard]] Described worst_json() const;
  [[nodiscard]] Described cause_json() const;

  std::string path_;
  LandfallFileReader file_;
  GridLayerReader grid_;
  EvaluationParameters parameters_;
  BinIndex bin_, centre_;  ///< in the map and in the window
  Footprint footprint_;
  GridSpec window_;
  std::vector<BinIndex> inside_;  ///< the footprint's bins of the window
  ErrorsAbout errors_;
  Grid<double> spread_, time_;  ///< of the DEM; empty without one
  Grid<double> slope_;          ///< tangent
  Grid<BinRanges> ranges_;      ///< of the scan; empty without one or without true ranges
  std::optional<LidarMotion> motion_;
  std::array<double, 4> shares_{};  ///< of the limits, by Missed
  std::optional<Missed> missed_;
  bool is_judged_ = false;
};

void FootprintFile::read_dem(const std::filesystem::path& path) {
  const LandfallFileReader dem(path, {"dem"});
  require_input(file_, inputs_of(file_, file_.file_id(), "dem"), dem);
  const GridLayerReader layers(dem);
  if (layers.spec() != grid_.spec()) dem.fail("has another grid than " + file_.name());
  const auto read = [&](const char* name) {
    return layers.has(name) ? layers.read_part(name, window_) : Grid<double>(window_, kNan);
  };
  if (layers.has("count")) errors_.count = read("count");
  spread_ = read("z_spread");
  time_ = read("t_mean");
  const Grid<double> z = read(layers.has("z_true") ? "z_true" : "z_est");
  slope_ = Grid<double>(window_, kNan);
  for (const BinIndex bin : inside_) {
    const std::array<double, 2> slope = gradient_at(z, bin);
    slope_.at(bin) = portable::hypot(slope[0], slope[1]);
  }
  if (layers.has("x_est_mean") && layers.has("y_est_mean"))
    errors_.positions = {read("x_est_mean"), read("y_est_mean"), z};
}

/// The ranges of the returns in each bin of the footprint.
void FootprintFile::read_ranges(const LandfallFileReader& scan, const Placement& placement,
                                const ProgressCallback& progress) {
  const TableReader points(scan.root(), "points", scan.name());
  if (!points.has("range_true") || !points.has("range_measured")) return;
  ranges_ = Grid<BinRanges>(window_);
  const std::size_t rows = points.row_count("status");
  std::array<std::vector<double>, 4> values;
  constexpr std::array kColumns = {"x_est", "y_est", "range_true", "range_measured"};
  std::vector<std::int8_t> status;
  for (std::size_t begin = 0; begin < rows; begin += kTableChunkRows) {
    const std::size_t count = std::min(kTableChunkRows, rows - begin);
    status.resize(count);
    points.read<std::int8_t>("status", begin, status);
    for (std::size_t k = 0; k < values.size(); ++k) {
      values[k].resize(count);
      points.read<double>(kColumns[k], begin, values[k]);
    }
    placement.to_first(values[0], values[1]);
    for (std::size_t i = 0; i < count; ++i) {
      const BinIndex bin = window_.bin_of(values[0][i], values[1][i]);
      if (!is_return(static_cast<PointStatus>(status[i])) || !window_.contains(bin)) continue;
      BinRanges& found = ranges_.at(bin);
      const double error = values[3][i] - values[2][i];
      ++found.count;
      found.sum += error;
      found.squares += error * error;
    }
    report(progress, static_cast<double>(begin + count) / static_cast<double>(rows));
  }
}

/// The estimated motion in a tenth of the scan about the time of the footprint, or in the whole of a short
/// one.
void FootprintFile::read_motion(const ScanReader& scan, const Placement& placement) {
  const TableReader pulses(scan.file().root(), "pulses", scan.file().name());
  const std::vector<double>& times = scan.pulse_times_s();
  constexpr std::array kColumns = {"px_est", "py_est", "pz_est", "qw_est", "qx_est", "qy_est", "qz_est"};
  if (times.size() < 2 || !std::ranges::all_of(kColumns, [&](const char* name) { return pulses.has(name); }))
    return;
  const double middle_s = spread_.values().empty() ? kNan : median(of_footprint(time_));
  const auto at = std::ranges::lower_bound(
      times, std::isfinite(middle_s) ? middle_s : (times.front() + times.back()) / 2);
  const auto reach = std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(times.size() / 20));
  const auto last = static_cast<std::ptrdiff_t>(times.size()) - 1;
  const auto from = static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, at - times.begin() - reach));
  const auto to = static_cast<std::size_t>(std::min(last, at - times.begin() + reach));
  std::array<std::array<double, 2>, kColumns.size()> pose{};
  for (std::size_t k = 0; k < kColumns.size(); ++k)
    for (const auto& [row, side] : {std::pair(from, 0), std::pair(to, 1)})
      pulses.read<double>(kColumns[k], row, std::span(&pose[k][static_cast<std::size_t>(side)], 1));
  placement.to_first(pose[0], pose[1]);
  placement.raise(pose[2]);
  const double time_s = times[to] - times[from];
  if (!(time_s > 0)) return;
  const auto attitude = [&](std::size_t side) {
    return Eigen::Quaterniond(pose[3][side], pose[4][side], pose[5][side], pose[6][side]).normalized();
  };
  const Eigen::Vector3d turn = rotation_vector(attitude(1) * attitude(0).conjugate());
  motion_.emplace();
  for (std::size_t i = 0; i < 3; ++i) {
    motion_->position_m[i] = (pose[i][0] + pose[i][1]) / 2;
    motion_->velocity_mps[i] = (pose[i][1] - pose[i][0]) / time_s;
    motion_->rate_radps[i] = turn[static_cast<Eigen::Index>(i)] / time_s;
  }
}

void FootprintFile::read_scan(const std::filesystem::path& path, const ProgressCallback& progress) {
  const ScanReader scan(path);
  const std::vector<std::string> dems = inputs_of(file_, file_.file_id(), "dem");
  const Placement placement =
      placement_in_dem(file_, grid_.crs_wkt(), dems.empty() ? "" : dems.front(), scan);
  read_ranges(scan.file(), placement, progress);
  if (scan.has_truth()) read_motion(scan, placement);
}

/// The bins of the largest hole that reaches into the footprint.
double FootprintFile::largest_hole() const {
  const TableReader holes(file_.root(), "holes", file_.name());
  std::vector<double> sizes(holes.row_count("size_bins"));
  holes.read<double>("size_bins", 0, sizes);
  double largest = 0;
  for (const double id : of_footprint(part("hole_id")))
    if (id >= 1 && id <= static_cast<double>(sizes.size()))
      largest = std::max(largest, sizes[static_cast<std::size_t>(id) - 1]);
  return largest;
}

/// Sets `is_judged_`, `shares_` and `missed_`, and adds the errors and verdicts.
void FootprintFile::judge(Described& json) {
  std::array<std::array<double, 3>, 2> errors{};  // absolute, relative
  const std::array kAxes = {"x", "y", "z"};
  for (std::size_t i = 0; i < 3; ++i) {
    errors[0][i] = value(std::string("abs_") + kAxes[i]);
    errors[1][i] = value(std::string("rel_") + kAxes[i]);
  }
  const double horizontal_m = portable::hypot(errors[0][0], errors[0][1]);
  const auto fail = static_cast<std::int64_t>(value("fail"));
  is_judged_ = value("in_region") == 1;
  double distance = 0;
  const Grid<double> to_valid = part("distance_to_valid");
  const Grid<double> invalid = part("invalid");
  for (const BinIndex bin : inside_)
    if (invalid.at(bin) == 1 && !(to_valid.at(bin) <= distance)) distance = to_valid.at(bin);
  const double hole = largest_hole();
  json["errors"] = {
      {"absolute_m", {finite_json(errors[0][0]), finite_json(errors[0][1]), finite_json(errors[0][2])}},
      {"relative_m", {finite_json(errors[1][0]), finite_json(errors[1][1]), finite_json(errors[1][2])}},
      {"horizontal_m", finite_json(horizontal_m)}};
  json["judged"] = is_judged_;
  json["verdicts"] = Described::array();
  const auto add = [&](Missed kind, const std::string& name, double found, std::optional<bool> misses) {
    const auto* const words =
        std::ranges::find(dictionary::kRequirements, name, &dictionary::Requirement::name);
    const double limit = limit_of_key(parameters_.limits, words->worst_limit).value();
    if (!misses) misses = !(found <= limit);
    json["verdicts"].push_back(
        {{"requirement", name},
         {"value", finite_json(found)},
         {"limit", limit},
         {"pass", is_judged_ && std::isfinite(found) ? Described(!*misses) : Described(nullptr)}});
    const double share = limit > 0 ? found / limit : std::numeric_limits<double>::infinity();
    double& kept = shares_[static_cast<std::size_t>(kind)];
    if (*misses) kept = std::max(kept, share);
  };
  const auto add_error = [&](Missed kind, double found) {
    add(kind, name_of(kind), found, (fail & kMissedBits[static_cast<std::size_t>(kind)]) != 0);
  };
  const auto name_of_hole = [](std::int64_t bit) { return requirement_of(static_cast<FailFlag>(bit)); };
  add_error(Missed::elevation, errors[1][2]);
  add_error(Missed::position, std::max(errors[1][0], errors[1][1]));
  add_error(Missed::place, horizontal_m);
  add(Missed::coverage, name_of_hole(kHoleBits[0]), hole, std::nullopt);
  add(Missed::coverage, name_of_hole(kHoleBits[1]), distance, std::nullopt);
  const auto worst = std::ranges::max_element(shares_);
  if (is_judged_ && *worst > 0) missed_ = static_cast<Missed>(worst - shares_.begin());
}

/// Returns, noise and slope in the footprint, as far as they are known.
Described FootprintFile::bins_json(const FootprintSources& sources) const {
  std::int64_t valid = 0;
  for (const BinIndex bin : inside_) valid += std::isfinite(errors_.z.at(bin)) ? 1 : 0;
  Described json = {{"bins", inside_.size()}, {"with_elevation", valid}};
  if (sources.dem) {
    std::vector<double> counts;
    if (errors_.count)
      for (const BinIndex bin : inside_)
        if (errors_.count->at(bin) > 0) counts.push_back(errors_.count->at(bin));
    const std::vector<double> slopes = of_footprint(slope_);
    double steepest = kNan;
    for (const double slope : slopes)
      if (!(slope <= steepest) && std::isfinite(slope)) steepest = slope;
    json.update(Described{{"median_returns_per_bin", finite_json(median(counts))},
                          {"median_spread_m", finite_json(median(of_footprint(spread_)))},
                          {"median_slope_deg", finite_json(slope_deg(median(slopes)))},
                          {"steepest_slope_deg", finite_json(slope_deg(steepest))}});
  }
  if (sources.scan && !ranges_.values().empty()) {
    BinRanges all;
    for (const BinIndex bin : inside_) {
      all.count += ranges_.at(bin).count;
      all.sum += ranges_.at(bin).sum;
      all.squares += ranges_.at(bin).squares;
    }
    const auto n = static_cast<double>(all.count);
    json.update(
        Described{{"return_count", all.count},
                  {"range_error_mean_m", finite_json(all.sum / n)},
                  {"range_noise_m", finite_json(std::sqrt(all.squares / n - all.sum / n * all.sum / n))}});
  }
  return json;
}

/// The bins of the largest errors by the measure of the requirement that the footprint misses most.
Described FootprintFile::worst_json() const {
  std::array<double, 3> mean{};
  const std::array<const Grid<double>*, 3> layers = {&errors_.x, &errors_.y, &errors_.z};
  for (std::size_t i = 0; i < 3; ++i) {
    double count = 0;
    for (const double value : of_footprint(*layers[i]))
      if (std::isfinite(value)) mean[i] += value, ++count;
    mean[i] = count > 0 ? mean[i] / count : 0;
  }
  const Missed kind = missed_.value_or(Missed::elevation);
  const Grid<double> to_valid = part("distance_to_valid");
  const auto badness = [&](BinIndex bin) {
    const double x = errors_.x.at(bin), y = errors_.y.at(bin);
    switch (kind) {
      case Missed::elevation:
        return std::abs(errors_.z.at(bin) - mean[2]);
      case Missed::position:
        return std::max(std::abs(x - mean[0]), std::abs(y - mean[1]));
      case Missed::place:
        return portable::hypot(x, y);
      default:
        return std::isfinite(errors_.z.at(bin)) ? kNan : to_valid.at(bin);
    }
  };
  std::vector<std::pair<double, BinIndex>> bins;
  for (const BinIndex bin : inside_)
    if (const double bad = badness(bin); std::isfinite(bad)) bins.emplace_back(bad, bin);
  std::ranges::stable_sort(bins, std::greater(), &std::pair<double, BinIndex>::first);
  Described list = Described::array();
  for (std::size_t k = 0; k < std::min(kWorstBins, bins.size()); ++k) {
    const BinIndex bin = bins[k].second;
    Described entry = {{"x_m", window_.x(bin.col)},
                       {"y_m", window_.y(bin.row)},
                       {"e_x_m", finite_json(errors_.x.at(bin))},
                       {"e_y_m", finite_json(errors_.y.at(bin))},
                       {"e_z_m", finite_json(errors_.z.at(bin))}};
    if (errors_.count) entry["returns"] = static_cast<std::int64_t>(errors_.count->at(bin));
    if (!spread_.values().empty()) {
      entry["spread_m"] = finite_json(spread_.at(bin));
      entry["slope_deg"] = finite_json(slope_deg(slope_.at(bin)));
    }
    list.push_back(std::move(entry));
  }
  return list;
}

Described FootprintFile::cause_json() const {
  if (!missed_) return nullptr;
  const FootprintAbout about{centre_, footprint_, shares_[static_cast<std::size_t>(Missed::elevation)]};
  const Measures measures = measure_errors(errors_, about, motion_);
  const std::vector<std::string> likely = likely_causes(*missed_, measures);
  Described rules = Described::array();
  for (const CauseRule& rule : kCauseRules) {
    if (rule.missed != *missed_) continue;
    const auto found = measures[static_cast<std::size_t>(rule.measure)];
    rules.push_back({{"cause", rule.cause},
                     {"measure", words_of(rule.measure)},
                     {"value", found ? Described(*found) : Described(nullptr)},
                     {rule.at_least ? "at_least" : "at_most", rule.bound},
                     {"holds", holds(rule, measures)}});
  }
  return {{"requirement", name_of(*missed_)},
          {"name", likely.size() == 1 ? likely.front() : "unclear"},
          {"sentence", cause_text(*missed_, measures)},
          {"alike", likely.size() > 1 ? Described(likely) : Described::array()},
          {"rules", std::move(rules)}};
}

Described FootprintFile::json(const FootprintSources& sources, const ProgressCallback& progress) {
  errors_ = {part("e_x"), part("e_y"), part("e_z"), std::nullopt, std::nullopt};
  if (sources.dem) read_dem(*sources.dem);
  if (sources.scan) read_scan(*sources.scan, progress);
  Described json = place_of_bin(path_, grid_, bin_);
  json["footprint_bins"] = footprint_.edge_bins();
  judge(json);
  json["bins"] = bins_json(sources);
  json["worst_bins"] = worst_json();
  json["cause"] = cause_json();
  json["missing"] = Described::array();
  for (const auto& [option, given] :
       {std::pair("--dem", sources.dem.has_value()), std::pair("--scan", sources.scan.has_value())})
    if (!given) json["missing"].push_back(option);
  return json;
}

}  // namespace

nlohmann::ordered_json describe_footprint(const std::filesystem::path& evaluation, const SitePoint& point,
                                          const FootprintSources& sources, const ProgressCallback& progress) {
  return FootprintFile(evaluation, point).json(sources, progress);
}

}  // namespace landfall
