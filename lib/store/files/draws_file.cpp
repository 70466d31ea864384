// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/draws_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "base/core/mapped.h"
#include "base/dictionary/tables/stages.h"
#include "base/numerics/non_finite.h"
#include "base/text/key_unit.h"
#include "base/text/number_text.h"
#include "chain/draws/draw_layers.h"
#include "store/files/contents.h"
#include "store/files/field_json.h"
#include "store/files/grid_file.h"
#include "store/files/hazard_file.h"
#include "store/files/metrics_json.h"
#include "store/hdf5/dataset_list.h"
#include "store/hdf5/table.h"

namespace landfall {
namespace {

using OrderedJson = nlohmann::ordered_json;

constexpr const char* kFirstDraw = "first_draw";

/// The column of /state: p_NAME is the share of NAME.
std::string column_of(const FailureMap& map) { return map.layer + 2; }

void write_layers(LandfallFileWriter& file, const Draws& draws, const std::string& crs_wkt) {
  const DrawMaps& maps = *draws.maps;
  GridLayerWriter layers(file, maps.spec(), crs_wkt);
  layers.write("p_invalid", share_of_draws(maps.invalid, maps.draws, nullptr));
  for (const FailureMap& map : failure_maps(maps))
    layers.write(map.layer,
                 share_of_draws(map.count, judged_draws(draws.table, map.requirement), &*draws.region));
  if (maps.safety) {
    layers.write("p_judged_safe", share_of_known(*maps.safety, maps.safety->judged_safe));
    layers.write("p_missed_hazard", share_of_known(*maps.safety, maps.safety->missed));
  }
  layers.write("e_z_mean", mean_of(maps.e_z));
  layers.write("e_z_std", std_of(maps.e_z));
  if (maps.e_map) layers.write("e_map_std", std_of(*maps.e_map));
  if (draws.predicted_sigma) {
    layers.write("z_sigma_abs", *draws.predicted_sigma);
    layers.write("e_map_std_over_sigma", std_over_sigma(*maps.e_map, *draws.predicted_sigma));
  }
  if (draws.map_truth) layers.write("z_true_map", *draws.map_truth);
  layers.write("count_mean", mean_count(maps));
  layers.write("in_region", *draws.region);
}

/// One column of the state, and its rows piece by piece.
struct StateColumn {
  ColumnSpec spec;
  std::function<ColumnRows(std::size_t begin, std::size_t count)> rows;
};

/// The sums that merge adds: a row per bin, in the order of the grid.
class StateTable {
 public:
  explicit StateTable(const DrawMaps& maps) : maps_(maps) {
    const std::string footprint = "draws in which the footprint exceeds the limit of ";
    add("invalid", maps.invalid, "1", "draws in which the bin has no elevation");
    for (const FailureMap& map : failure_maps(maps))
      add(column_of(map), map.count, "1", footprint + map.error);
    add("count", maps.count, "1", "returns");
    add("e_z", maps.e_z);
    if (maps.e_map) add("e_map", *maps.e_map);
    if (!maps.safety) return;
    add("safety_known", maps.safety->known, "1",
        "draws in which the safety of the place is known in map and truth");
    add("safety_judged_safe", maps.safety->judged_safe, "1", "of these, draws in which the map says safe");
    add("safety_missed", maps.safety->missed, "1", "of these, draws in which the place is a hazard in truth");
  }

  /// In pieces, so that little memory is needed besides the maps.
  void write(const LandfallFileWriter& file) {
    constexpr std::size_t kPieceRows = 4 * kTableChunkRows;
    TableWriter table(file.root(), "state", mapped(columns_, &StateColumn::spec), file.compression());
    for (std::size_t begin = 0; begin < maps_.spec().size(); begin += kPieceRows) {
      const std::size_t count = std::min(kPieceRows, maps_.spec().size() - begin);
      table.append(mapped(columns_, [&](const StateColumn& column) { return column.rows(begin, count); }));
    }
    table.finish();
  }

 private:
  template <class T>
  void add(const std::string& name, const Grid<T>& values, const std::string& units,
           const std::string& text) {
    columns_.push_back(
        {{name, h5::TypeOf<T>::value, units, text}, [&values](std::size_t begin, std::size_t count) {
           return ColumnRows(values.values().subspan(begin, count));
         }});
  }

  void add(const std::string& name, const ErrorSums& sums) {
    add(name + "_count", sums.count, "1", "draws in which the bin has this error");
    add(name + "_sum", sums.sum, "2^-30 m", "sum of the error");
    const auto word = [&](const std::string& suffix, const std::string& units, const std::string& text,
                          auto value) {
      auto& values = words_.emplace_back(std::make_unique<std::vector<std::int64_t>>());
      columns_.push_back({{name + suffix, h5::Type::int64, units, text},
                          [&sums, value, buffer = values.get()](std::size_t begin, std::size_t count) {
                            buffer->resize(count);
                            for (std::size_t i = 0; i < count; ++i)
                              (*buffer)[i] = value(sums.squares.values()[begin + i]);
                            return ColumnRows(std::span<const std::int64_t>(*buffer));
                          }});
    };
    word("_squares_low", "2^-60 m^2", "sum of the squares of the error modulo 2^64, two's complement",
         [](const WideSum& sum) { return static_cast<std::int64_t>(sum.low); });
    word("_squares_high", "2^4 m^2", "sum of the squares of the error divided by 2^64, rounded down",
         [](const WideSum& sum) { return sum.high; });
  }

  const DrawMaps& maps_;
  std::vector<StateColumn> columns_;
  std::vector<std::unique_ptr<std::vector<std::int64_t>>> words_;
};

/// The unit of scan.navigation_error.velocity_mps.0 and accuracy.absolute.x.p95_m; counts and bins have 1.
std::string unit_of_column(std::string name) {
  if (const std::size_t dot = name.rfind('.');
      dot + 2 == name.size() && name.back() >= '0' && name.back() <= '9')
    name.resize(dot);
  const std::string_view unit = unit_of_key(name);
  return std::string(unit.empty() ? "1" : unit);
}

bool is_landing_flag(const std::string& name) { return name == kLandingSafe || name == kBlindSafe; }

std::vector<std::int8_t> flags_of(const DrawColumn& column) {
  return mapped(column.values, [](double value) { return static_cast<std::int8_t>(value); });
}

void write_rows(const LandfallFileWriter& file, const DrawTable& table) {
  using enum h5::Type;
  std::vector<ColumnSpec> columns = {{"seed", int64, "1", "random seed"},
                                     {"draw", int64, "1", "number of the draw"}};
  std::vector<ColumnRows> rows = {std::span(table.seeds), std::span(table.draws)};
  for (const DrawColumn& column : table.varied) {
    columns.push_back(
        {column.name, float64, unit_of_column(column.name), "value of this key of the configuration"});
    rows.emplace_back(std::span(column.values));
  }
  std::deque<std::vector<std::int8_t>> flags;
  for (const DrawColumn& column : table.metrics) {
    if (is_landing_flag(column.name)) {
      columns.push_back({column.name, int8, "1", "whether the landing is safe", {0, 1}, "no yes"});
      rows.emplace_back(std::span<const std::int8_t>(flags.emplace_back(flags_of(column))));
      continue;
    }
    columns.push_back({column.name, float64, unit_of_column(column.name),
                       "metric of metrics.json, score.json, of the best site or of a landing"});
    rows.emplace_back(std::span(column.values));
  }
  constexpr std::size_t kCount = dictionary::kRequirements.size();
  const std::string all = "all " + (kCount == 6 ? "six" : std::to_string(kCount)) + " requirements";
  const std::string of = all + (own_columns(table).empty() ? "" : " and the user's own");
  columns.push_back({"pass", int8, "1", "whether " + of + " passed", {-1, 0, 1}, "not_judged no yes"});
  rows.emplace_back(std::span(table.pass));
  write_table(file.root(), "draws", std::move(columns), rows, file.compression());
  h5::write_attribute(h5::open_group(file.root(), "draws").get(), kFirstDraw, table.first);
}

/// Varied keys begin with the name of their stage; no metric does.
bool is_varied(const std::string& name) {
  return name == kPairColumn || std::ranges::any_of(dictionary::kStages, [&](const dictionary::Stage& stage) {
           return name.starts_with(stage.name + std::string("."));
         });
}

/// Refuses values that no run of draws has, because sums of them could overflow.
template <class T>
void require_at_most(const LandfallFileReader& file, const std::string& name, const Grid<T>& values,
                     std::int64_t minimum, std::int64_t maximum) {
  for (const T value : values.values())
    if (value < minimum || value > maximum)
      file.fail("/state/" + name + ": " + std::to_string(value) + " is not in [" + std::to_string(minimum) +
                ", " + std::to_string(maximum) + "]");
}

struct NamedCounts {
  const char* name;
  const Grid<std::int32_t>& values;
};

/// Refuses a part that is larger than its whole.
void require_no_more(const LandfallFileReader& file, const NamedCounts& part, const NamedCounts& whole) {
  for (std::size_t i = 0; i < part.values.spec().size(); ++i)
    if (part.values.values()[i] > whole.values.values()[i])
      file.fail(std::string("/state/") + part.name + ", row " + std::to_string(i) + ": " +
                std::to_string(part.values.values()[i]) + " is more than " + whole.name + ", " +
                std::to_string(whole.values.values()[i]));
}

/// Appends the numbers of a tree by their dotted paths: null as NaN, true as 1.
void flatten(const OrderedJson& tree, const std::string& path, std::vector<NamedNumber>& flat) {
  if (tree.is_object()) {
    for (const auto& [key, inner] : tree.items())
      if (key != "pass" || !path.empty()) flatten(inner, path.empty() ? key : path + "." + key, flat);
  } else if (!tree.is_array() && !tree.is_string() && !path.ends_with("version")) {
    flat.emplace_back(path, tree.is_number()    ? tree.get<double>()
                            : tree.is_boolean() ? static_cast<double>(tree.get<bool>())
                                                : kNan);
  }
}

/// Calls each(name, sums) for the errors that the maps have.
void for_each_error(auto& maps, const auto& each) {
  each("e_z", maps.e_z);
  if (maps.e_map) each("e_map", *maps.e_map);
}

constexpr std::int64_t kMaxDraws = std::int64_t{1} << 17;  ///< for which ErrorSums is exact

void check_state(const LandfallFileReader& file, const DrawMaps& maps) {
  constexpr std::int64_t kMaxError = std::int64_t{1} << 46;    // 65,536 m in 2^-30 m
  constexpr std::int64_t kMaxReturns = std::int64_t{1} << 52;  // in all draws of a run, below 2^63
  require_at_most(file, "invalid", maps.invalid, 0, maps.draws);
  for (const FailureMap& map : failure_maps(maps))
    require_at_most(file, column_of(map), map.count, 0, maps.draws);
  require_at_most(file, "count", maps.count, 0, kMaxReturns);
  if (maps.safety) {
    require_at_most(file, "safety_known", maps.safety->known, 0, maps.draws);
    require_at_most(file, "safety_judged_safe", maps.safety->judged_safe, 0, maps.draws);
    require_at_most(file, "safety_missed", maps.safety->missed, 0, maps.draws);
    require_no_more(file, {"safety_judged_safe", maps.safety->judged_safe},
                    {"safety_known", maps.safety->known});
    require_no_more(file, {"safety_missed", maps.safety->missed},
                    {"safety_judged_safe", maps.safety->judged_safe});
  }
  for_each_error(maps, [&](const std::string& prefix, const ErrorSums& sums) {
    require_at_most(file, prefix + "_count", sums.count, 0, maps.draws);
    require_at_most(file, prefix + "_sum", sums.sum, -maps.draws * kMaxError, maps.draws * kMaxError);
    const std::int64_t max_high = maps.draws * (kMaxError >> 18);  // of squares below draws * 2^92
    for (const WideSum& squares : sums.squares.values())
      if (squares.high < 0 || squares.high > max_high)
        file.fail("/state/" + prefix + "_squares_high: " + std::to_string(squares.high) + " is not in [0, " +
                  std::to_string(max_high) + "]");
  });
}

DrawMaps read_state(const LandfallFileReader& file, const GridSpec& spec, std::int64_t draws) {
  const TableReader table(file.root(), "state", file.name());
  if (table.row_count("invalid") != spec.size()) file.fail("/state does not fit the grid");
  DrawMaps maps(spec);
  maps.draws = draws;
  table.read("invalid", 0, maps.invalid.values());
  for (std::size_t k = 0; k < maps.failing.size(); ++k)
    table.read(column_of(failure_maps(maps)[k]), 0, maps.failing[k].values());
  table.read("count", 0, maps.count.values());
  if (table.has("safety_known")) {
    SafetyCounts& safety = maps.safety.emplace(spec);
    table.read("safety_known", 0, safety.known.values());
    table.read("safety_judged_safe", 0, safety.judged_safe.values());
    table.read("safety_missed", 0, safety.missed.values());
  }
  std::vector<std::int64_t> low(spec.size());
  std::vector<std::int64_t> high(spec.size());
  if (!table.has("e_map_count")) maps.e_map.reset();
  for_each_error(maps, [&](const std::string& prefix, ErrorSums& sums) {
    table.read(prefix + "_count", 0, sums.count.values());
    table.read(prefix + "_sum", 0, sums.sum.values());
    table.read(prefix + "_squares_low", 0, std::span(low));
    table.read(prefix + "_squares_high", 0, std::span(high));
    for (std::size_t i = 0; i < low.size(); ++i)
      sums.squares.values()[i] = {static_cast<std::uint64_t>(low[i]), high[i]};
  });
  check_state(file, maps);
  return maps;
}

[[noreturn]] void fail_at(const LandfallFileReader& file, const std::string& column, std::size_t row,
                          double value, const std::string& expected) {
  file.fail("/draws/" + column + ", row " + std::to_string(row) + ": " + number_text(value) + " is not " +
            expected);
}

/// Modulo 2^64: a file may hold any number.
std::int64_t sum_of(std::int64_t a, std::int64_t b) {
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}

/// A column with one number for each draw.
struct Numbering {
  const char* column;
  const std::vector<std::int64_t>& values;
  std::int64_t step;  ///< from a draw to the next
  const char* meaning;
};

/// With several scans, each counts from its own first draw. `first`: in a run of draws over one scan.
void check_numbering(const LandfallFileReader& file, const DrawTable& table, const Numbering& numbering,
                     const std::optional<std::int64_t>& first) {
  const auto pair = std::ranges::find(table.varied, kPairColumn, &DrawColumn::name);
  const bool has_pairs = pair != table.varied.end();
  const auto expect = [&](std::size_t row, std::int64_t expected) {
    if (const std::int64_t value = numbering.values[row]; value != expected)
      fail_at(file, numbering.column, row, static_cast<double>(value),
              std::to_string(expected) + ", " + numbering.meaning);
  };
  if (first && !has_pairs && !numbering.values.empty()) expect(0, *first);
  for (std::size_t i = 1; i < numbering.values.size(); ++i)
    if (!has_pairs || pair->values[i] == pair->values[i - 1])
      expect(i, sum_of(numbering.values[i - 1], numbering.step));
}

/// Draw i has the seed of the run and the number i; in a file of version 0.2.0 the seed of the run
/// of draws plus i.
void check_seeds(const LandfallFileReader& file, const DrawTable& table, bool counts_seeds) {
  static const nlohmann::json::json_pointer kSeed("/scan/seed");
  const nlohmann::json& config = file.config();
  std::optional<std::int64_t> seed;
  if (config.is_object() && config.contains(kSeed) && config.at(kSeed).is_number_integer())
    seed = config.at(kSeed).get<std::int64_t>();
  if (counts_seeds) {
    if (seed) seed = sum_of(*seed, table.first);
    return check_numbering(file, table,
                           {"seed", table.seeds, 1, "the seed of the run plus the number of the draw"}, seed);
  }
  check_numbering(file, table, {"seed", table.seeds, 0, "the seed of the run"}, seed);
  check_numbering(file, table, {"draw", table.draws, 1, "the number of the draw"}, table.first);
}

/// Throws FormatError unless each value of the metric is `allowed` or NaN; a table may lack the metric.
template <class Allowed>
void check_metric(const LandfallFileReader& file, const DrawTable& table, const std::string& name,
                  const std::string& expected, const Allowed& allowed) {
  const DrawColumn* const column = find_metric(table, name);
  if (column == nullptr) return;
  for (std::size_t i = 0; i < column->values.size(); ++i)
    if (!std::isnan(column->values[i]) && !allowed(column->values[i]))
      fail_at(file, name, i, column->values[i], expected);
}

bool is_flag(double value) { return value == 0 || value == 1; }

/// A landing has all its columns, and its flag is 0 or 1.
void check_landings(const LandfallFileReader& file, const DrawTable& table) {
  static constexpr std::array kColumns = {"landing.x_m",       "landing.y_m",         "landing.yaw_deg",
                                          "landing.slope_deg", "landing.roughness_m", kLandingSafe,
                                          "blind.x_m",         "blind.y_m",           "blind.yaw_deg",
                                          "blind.slope_deg",   "blind.roughness_m",   kBlindSafe};
  const auto is_missing = [&](const char* name) { return find_metric(table, name) == nullptr; };
  if (std::ranges::all_of(kColumns, is_missing)) return;
  for (const char* const name : kColumns)
    if (is_missing(name)) file.fail("/draws has no column " + std::string(name));
  for (const char* const name : {kLandingSafe, kBlindSafe})
    check_metric(file, table, name, "0 or 1", is_flag);
}

/// Refuses rows that contradict themselves or the configuration: no run of draws wrote them.
void check_rows(const LandfallFileReader& file, const DrawTable& table, bool counts_seeds) {
  check_seeds(file, table, counts_seeds);
  for (const dictionary::Requirement& words : dictionary::kRequirements)
    check_metric(file, table, std::string("requirements.") + words.name + ".pass", "0 or 1", is_flag);
  const std::vector<OwnColumn> own = own_columns(table);
  for (const OwnColumn& column : own) check_metric(file, table, column.passes->name, "0 or 1", is_flag);
  check_metric(file, table, "site.true_safe", "0 or 1", is_flag);
  check_landings(file, table);
  check_metric(file, table, "score.missed_hazard_frac", "in [0, 1]",
               [](double value) { return value >= 0 && value <= 1; });
  const std::vector<std::int8_t> six = six_passed(table);
  for (std::size_t i = 0; i < table.pass.size(); ++i) {
    const bool all_own =
        std::ranges::all_of(own, [&](const OwnColumn& column) { return column.passes->values[i] == 1; });
    const std::int8_t expected = all_own ? six[i] : pass_flag(false);
    if (table.pass[i] != expected)
      fail_at(file, "pass", i, table.pass[i], std::to_string(expected) + ", which its requirements give");
  }
}

DrawTable read_rows(const LandfallFileReader& file, bool counts_seeds) {
  const TableReader table(file.root(), "draws", file.name());
  DrawTable result;
  const auto first = h5::read_number_attribute(table.group(), kFirstDraw);
  if (!first) file.fail("/draws has no attribute first_draw");
  const std::size_t size = table.row_count("seed");
  if (size > kMaxDraws) file.fail("/draws has more than " + std::to_string(kMaxDraws) + " rows");
  if (!(*first >= 0 && *first < static_cast<double>(kMaxDraws)))
    file.fail("/draws: first_draw is not in [0, " + std::to_string(kMaxDraws) + ")");
  result.first = static_cast<std::int64_t>(*first);
  result.seeds.resize(size);
  result.draws.resize(size);
  result.pass.resize(size);
  table.read("seed", 0, std::span(result.seeds));
  if (!counts_seeds) table.read("draw", 0, std::span(result.draws));
  table.read("pass", 0, std::span(result.pass));
  for (const DatasetEntry& dataset : list_datasets(table.group())) {
    if (dataset.name == "seed" || dataset.name == "draw" || dataset.name == "pass") continue;
    if (table.row_count(dataset.name) != size)
      file.fail(table.path_of(dataset.name) + " has another length than seed");
    DrawColumn column{dataset.name, std::vector<double>(size)};
    table.read(dataset.name, 0, std::span(column.values));
    (is_varied(dataset.name) ? result.varied : result.metrics).push_back(std::move(column));
  }
  for (const dictionary::Requirement& words : dictionary::kRequirements) {
    const std::string name = std::string("requirements.") + words.name + ".pass";
    if (std::ranges::find(result.metrics, name, &DrawColumn::name) == result.metrics.end())
      file.fail("/draws has no column " + name);
  }
  check_rows(file, result, counts_seeds);
  return result;
}

}  // namespace

std::vector<NamedNumber> flat_metrics(const DrawResult& result) {
  std::vector<NamedNumber> flat;
  const Metrics* const full = std::get_if<Metrics>(&result.metrics);
  flatten(full != nullptr ? metrics_json(*full) : fields_json(std::get<DecisiveMetrics>(result.metrics)), "",
          flat);
  if (!result.hazards) return flat;
  const auto landing = [&](const std::string& arm, const Landing& landed) {
    flatten(OrderedJson{{"x_m", landed.touchdown.x_m},
                        {"y_m", landed.touchdown.y_m},
                        {"yaw_deg", landed.touchdown.yaw_deg},
                        {"slope_deg", landed.slope_deg},
                        {"roughness_m", landed.roughness_m},
                        {"safe", landed.is_safe ? 1 : 0}},
            arm, flat);
  };
  flatten(score_json(result.hazards->score), "score", flat);
  const std::size_t begin = flat.size();
  flatten(site_json(result.hazards->best.value_or(LandingSite{})), "site", flat);
  if (!result.hazards->best)
    for (std::size_t i = begin; i < flat.size(); ++i) flat[i].second = kNan;
  if (result.landings) {
    landing("landing", result.landings->lidar);
    landing("blind", result.landings->blind);
  }
  return flat;
}

void write_draws(LandfallFileWriter& file, const Draws& draws, const OrderedJson& verdict,
                 const std::string& crs_wkt) {
  if (draws.maps) write_layers(file, draws, crs_wkt);
  write_rows(file, draws.table);
  if (draws.footprint_bins) h5::write_attribute(file.root(), kFootprintBins, *draws.footprint_bins);
  h5::write_text(file.root(), {"verdict_json", "how many draws passed each requirement"}, verdict.dump(2));
  if (draws.maps) StateTable(*draws.maps).write(file);
  file.commit();
}

DrawsInput read_draws(const std::filesystem::path& path) {
  const LandfallFileReader file(path, {"draws"});
  DrawsInput input;
  input.counts_seeds = file.format_major() == 1;
  input.draws.table = read_rows(file, input.counts_seeds);
  input.file_id = file.file_id();
  input.chain = file.chain();
  if (input.chain.empty()) file.fail("does not say how it was made: /provenance is missing");
  if (const auto bins = h5::read_number_attribute(file.root(), kFootprintBins))
    input.draws.footprint_bins = static_cast<std::int64_t>(*bins);
  if (!has_grid(file)) return input;
  const GridLayerReader layers(file);
  input.crs_wkt = layers.crs_wkt();
  input.draws.region = layers.read<std::int8_t>("in_region");
  if (layers.has("z_true_map"))
    input.draws.map_truth = layers.read_checked<float>("z_true_map", LayerValues::finite);
  if (layers.has("z_sigma_abs"))
    input.draws.predicted_sigma = layers.read_checked<float>("z_sigma_abs", LayerValues::not_negative);
  input.draws.maps = read_state(file, layers.spec(), input.draws.table.size());
  if (input.draws.maps->e_map.has_value() != input.draws.map_truth.has_value())
    file.fail("z_true_map and /state/e_map_count belong together, and one of them is missing");
  return input;
}

}  // namespace landfall
