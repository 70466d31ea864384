// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/description_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "app/cli/comparison_text.h"
#include "app/cli/plan.h"
#include "app/cli/print.h"
#include "app/cli/result_tables.h"
#include "base/core/error.h"
#include "base/dictionary/tables/tools.h"
#include "base/text/joined.h"
#include "base/text/netcdf_name.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"
#include "store/config/dem_config.h"
#include "store/config/resolved_config.h"
#include "store/files/field_json.h"
#include "store/files/metrics_json.h"

namespace landfall::cli {
namespace {

using OrderedJson = nlohmann::ordered_json;

/// Columns of a unit, which a foreign file may write at any length.
constexpr std::size_t kUnitWidth = 24;

std::string line(const char* name, const std::string& value) {
  return print("  %-11s ", name) + fitted(value, 14) + "\n";
}

std::string integer(const OrderedJson& value) {
  return value.is_number_integer() ? std::to_string(value.get<std::int64_t>()) : "-";
}

std::string number(const OrderedJson& value) {
  return value.is_number() ? statistic_text(value.get<double>()) : "-";
}

std::string metres(const OrderedJson& value) {
  return value.is_number() ? print("%.6g", value.get<double>()) : "-";
}

/// Keeps the digits of clocks whose seconds are large numbers.
std::string time_text(const OrderedJson& value) {
  return value.is_number() ? print("%.15g", value.get<double>()) : "-";
}

std::string range(const OrderedJson& pair, const char* unit) {
  return pair.is_array() ? metres(pair[0]) + " to " + metres(pair[1]) + " " + unit : "-";
}

std::string bytes(double count) {
  constexpr std::array kUnits = {"bytes", "kB", "MB", "GB", "TB"};
  std::size_t unit = 0;
  for (; count >= 999.5 && unit + 1 < kUnits.size(); ++unit) count /= 1000;
  return print("%.*f %s", unit == 0 || count >= 99.5 ? 0 : 1, count, kUnits[unit]);
}

/// The centre of a site on its map.
std::string origin_lines(const OrderedJson& crs) {
  std::string text;
  if (crs.contains("origin"))
    for (const std::string& place : place_lines(crs["origin"]))
      text += line(text.empty() ? "origin" : "", place);
  return text;
}

std::string head(const OrderedJson& d) {
  const std::string title = d["title"].get<std::string>();
  return fitted(d["file"].get<std::string>() + ": " + d["kind"].get<std::string>() +
                (title.empty() ? "" : " (" + title + ")")) +
         "\n" + line("made by", d["source"].get<std::string>()) +
         line("file id", d["file_id"].get<std::string>()) +
         line("format", "version " + d["format_version"].get<std::string>() + ", complete, " +
                            bytes(d["size_bytes"].get<double>())) +
         line("frame", d["crs"]["name"].get<std::string>()) + origin_lines(d["crs"]);
}

std::string extent(const OrderedJson& d) {
  std::string text;
  if (d.contains("grid")) {
    const OrderedJson& g = d["grid"];
    const bool nodes = d["kind"] == "terrain";  // elevations at points, not means over bins
    text += line("grid", integer(g["columns"]) + " x " + integer(g["rows"]) +
                             (nodes ? " nodes, one every " : " bins of ") +
                             number_text(g["resolution_m"].get<double>()) + " m");
    text += line("extent", "x " + range(g["x_m"], "m") + ", y " + range(g["y_m"], "m") +
                               (nodes ? "" : " (centres of the bins)"));
  }
  if (d.contains("opens_as"))  // never cut, to be copied
    for (const auto& [program, name] : {std::pair("GDAL, QGIS", "gdal"), std::pair("GMT", "gmt")})
      text += print("  %-11s ", program) +
              (d["opens_as"][name].is_null() ? kNoNetcdfName : d["opens_as"][name].get<std::string>()) + "\n";
  if (d.contains("mesh")) {
    const OrderedJson& m = d["mesh"];
    text += line("mesh",
                 integer(m["vertex_count"]) + " vertices, " + integer(m["triangle_count"]) + " triangles");
    if (m["x_m"].is_array())
      text += line("extent", "x " + range(m["x_m"], "m") + ", y " + range(m["y_m"], "m") + ", z " +
                                 range(m["z_m"], "m"));
  }
  return text;
}

/// "name count, name count".
std::string counts(const OrderedJson& by_name) {
  return joined(by_name.items(), ", ",
                [](const auto& item) { return item.key() + " " + integer(item.value()); });
}

/// Points that landfall did not make.
std::string imported_lines(const OrderedJson& s) {
  const auto coordinate = [&](const char* key) {
    return s[key].is_number() ? number_text(s[key].get<double>()) : "?";
  };
  OrderedJson by_status;
  for (const std::string name : {"return", "false_return"}) by_status[name] = s[name + "_count"];
  return line("imported", s["imported_from"].get<std::string>() + ", origin at " + coordinate("origin_x") +
                              ", " + coordinate("origin_y") + ", " + coordinate("origin_z")) +
         line("rows", integer(s["row_count"]) + ", one per point") + line("outcomes", counts(by_status));
}

std::string scan_lines(const OrderedJson& s) {
  if (s.contains("imported_from")) return imported_lines(s);
  std::string pulses = integer(s["pulse_count"]) + " of ";
  if (s["detector_rows"].is_number_integer() && s["detector_columns"].is_number_integer())
    pulses += integer(s["detector_rows"]) + " x " + integer(s["detector_columns"]) + " pixels";
  else
    pulses += integer(s["pixel_count"]) + " pixels";
  if (s["t_first_s"].is_number())
    pulses += ", from " + time_text(s["t_first_s"]) + " to " + time_text(s["t_last_s"]) + " s";
  OrderedJson by_status;
  for (const std::string name : {"return", "miss", "undetected", "dropout", "dead", "false_return"})
    if (s.contains(name + "_count")) by_status[name] = s[name + "_count"];  // undetected: with a receiver
  return line("pulses", pulses) +
         line("rows", integer(s["row_count"]) +
                          (s["misses_kept"].get<bool>() ? ", one per pixel and pulse" : ", one per return")) +
         line("outcomes", counts(by_status));
}

std::string feature_lines(const OrderedJson& f) {
  std::string text = integer(f["count"]);
  if (f["count_by_kind"].is_object() && !f["count_by_kind"].empty())
    text += ": " + counts(f["count_by_kind"]);
  return line("features", text);
}

std::size_t name_width(const OrderedJson& entries) {
  std::size_t width = 4;
  for (const OrderedJson& entry : entries) width = std::max(width, entry["name"].get<std::string>().size());
  return width;
}

/// Lists the entries without statistics.
std::string list_lines(const std::string& group, const OrderedJson& entries) {
  const int width = static_cast<int>(std::min<std::size_t>(name_width(entries), 40));
  std::string text =
      print("\n%-*s %-8s %10s  %-5s meaning\n", width + 2, group.c_str(), "type", "stored", "unit");
  for (const OrderedJson& e : entries)
    text += fitted(print("  %-*s %-8s %10s  %-5s ", width, e["name"].get<std::string>().c_str(),
                         e["type"].get<std::string>().c_str(), bytes(e["stored_bytes"].get<double>()).c_str(),
                         shortened(e["unit"].get<std::string>(), kUnitWidth).c_str()) +
                   e["long_name"].get<std::string>()) +
            "\n";
  return text;
}

/// Prints whole numbers with all digits if they are not too long.
std::string value_text(const OrderedJson& value, const std::string& type) {
  const bool whole = type.find("int") != std::string::npos && value.is_number();
  return whole && std::abs(value.get<double>()) < 1e7 ? print("%.0f", value.get<double>()) : number(value);
}

/// Lists the flags that occur, over several lines.
std::string flag_lines(const OrderedJson& by_name, int indent) {
  std::string text;
  std::string row;
  for (const auto& [name, count] : by_name.items()) {
    if (count == 0) continue;
    const std::string word = shortened(name, 40) + " " + integer(count);
    if (!row.empty() && row.size() + word.size() + static_cast<std::size_t>(indent) + 2 > page_width()) {
      text += print("%*s", indent, "") + row + ",\n";
      row.clear();
    }
    row += (row.empty() ? "" : ", ") + word;
  }
  return row.empty() ? "" : text + print("%*s", indent, "") + row + "\n";
}

/// The columns of a table of statistics.
struct TableShape {
  int name_width = 0;
  // Only where the page is wide enough:
  bool has_types = false;
  bool has_unit_title = false;
  // The counts have wide columns too where the page has room for them:
  int valid_width = 9;
  int nan_width = 8;
};

/// The digits of the largest count of this key, and at least those of its heading.
int count_width(const OrderedJson& entries, const char* key, const std::string& heading) {
  std::size_t width = heading.size();
  for (const OrderedJson& entry : entries) width = std::max(width, integer(entry[key]).size());
  return static_cast<int>(width);
}

TableShape shape_of(const std::string& title, const OrderedJson& entries) {
  TableShape shape;
  const std::size_t heading =
      title.size() < 2 ? 0 : title.size() - 2;  // it begins two columns before the names
  shape.name_width = static_cast<int>(std::min<std::size_t>(std::max(name_width(entries), heading), 40));
  std::size_t unit = 4;
  for (const OrderedJson& entry : entries)
    unit = std::max(unit, std::min(kUnitWidth, entry["unit"].get<std::string>().size()));
  const std::size_t numbers = static_cast<std::size_t>(shape.name_width) + 57;
  shape.has_types = numbers + unit + 9 <= page_width();
  shape.has_unit_title = numbers + 5 <= page_width();
  if (numbers + unit + 1 > page_width()) {
    shape.valid_width = count_width(entries, "count", "valid");
    shape.nan_width = count_width(entries, "nan_count", "NaN");
    const std::size_t others = static_cast<std::size_t>(shape.valid_width + shape.nan_width) + 41 + unit;
    shape.name_width = std::min(shape.name_width,
                                static_cast<int>(std::max<std::size_t>(page_width(), others + 12) - others));
  }
  return shape;
}

/// A name that is longer than its column has a line of its own.
std::string statistics_row(const TableShape& shape, const std::array<std::string, 9>& cells) {
  const auto name_width = static_cast<std::size_t>(shape.name_width) + 2;
  std::string text = cells[0].size() > name_width ? cells[0] + "\n" + std::string(name_width, ' ')
                                                  : print("%-*s", shape.name_width + 2, cells[0].c_str());
  if (shape.has_types) text += print(" %-7s", cells[1].c_str());
  text += print(" %*s %*s", shape.valid_width, cells[2].c_str(), shape.nan_width, cells[3].c_str());
  for (std::size_t i = 4; i < 8; ++i) text += print(" %8s", cells[i].c_str());
  return text + (cells[8] == "1" ? "" : " " + cells[8]) + "\n";
}

std::string statistics_lines(const OrderedJson& e, const TableShape& shape) {
  const std::string type = e["type"].get<std::string>();
  std::string text = statistics_row(
      shape, {"  " + e["name"].get<std::string>(), type, integer(e["count"]), integer(e["nan_count"]),
              value_text(e["min"], type), value_text(e["max"], type), number(e["mean"]), number(e["std"]),
              shortened(e["unit"].get<std::string>(), kUnitWidth)});
  if (e.contains("not_read"))
    text += print("  %-*s   not read: ", shape.name_width, "") + e["not_read"].get<std::string>() + "\n";
  else if (e["infinite_count"] != 0)
    text += print("  %-*s   infinite: ", shape.name_width, "") + integer(e["infinite_count"]) + "\n";
  if (e.contains("flag_counts")) text += flag_lines(e["flag_counts"], shape.name_width + 5);
  return text;
}

std::string dataset_lines(const std::string& group, const OrderedJson& entries) {
  if (entries.empty()) return "";
  std::string title = group == "layers" ? "layer" : "/" + group;
  if (group != "layers" && entries[0]["shape"].size() == 1)
    title += " (" + integer(entries[0]["shape"][0]) + ")";
  title = shortened(title, 40);
  if (!entries[0].contains("count")) return list_lines(title, entries);
  const TableShape shape = shape_of(title, entries);
  std::string text = "\n" + statistics_row(shape, {title, "type", "valid", "NaN", "min", "max", "mean", "std",
                                                   shape.has_unit_title ? "unit" : "1"});
  for (const OrderedJson& entry : entries) text += statistics_lines(entry, shape);
  return text;
}

/// The schema of a tool's configuration; empty for other tools.
std::string schema_of(const std::string& tool) {
  const auto* const found = std::ranges::find(dictionary::kTools, tool, &dictionary::Tool::name);
  return found == dictionary::kTools.end() ? "" : found->schema;
}

std::string config_lines(const OrderedJson& d) {
  const std::string schema = schema_of(d.value("tool", ""));
  if (!d["config"].is_object()) return "";
  if (schema.empty()) return "\nconfiguration\n" + d["config"].dump(2) + "\n";
  std::string text = "\nconfiguration, where it differs from the defaults\n";
  const std::vector<ConfigChange> changes = config_changes(d["config"], schema);
  for (const ConfigChange& change : changes)
    text += fitted("  " + shown_text(change.key) + " = " + change.value.dump()) + "\n";
  return text + (changes.empty() ? "  (nowhere)\n" : "");
}

std::string inputs_text(const OrderedJson& inputs) {
  std::string text;
  if (!inputs.is_array()) return text;
  for (const OrderedJson& input : inputs)
    if (input.is_object())
      text += (text.empty() ? "  from " : ", ") + input.value("role", "") + " " +
              input.value("file_id", "").substr(0, 12);
  return text;
}

std::string step_line(const OrderedJson& step) {
  const auto text_of = [&](const char* key) {
    return step.contains(key) && step[key].is_string() ? step[key].get<std::string>() : std::string();
  };
  return fitted(print("  %-12s %-6s %.12s", shortened(text_of("tool"), 40).c_str(),
                      shortened(text_of("version"), 20).c_str(), text_of("file_id").c_str()) +
                (step.contains("inputs") ? inputs_text(step["inputs"]) : "")) +
         "\n";
}

/// The values that were assumed because a file that a step read said nothing, or two things.
std::string assumed_lines(const OrderedJson& step) {
  std::string text;
  if (!step.contains("inputs") || !step["inputs"].is_array()) return text;
  for (const OrderedJson& input : step["inputs"])
    if (input.is_object() && input.contains("assumed") && input["assumed"].is_array())
      for (const OrderedJson& assumed : input["assumed"])
        if (assumed.is_string()) text += "    assumed: " + assumed.get<std::string>() + "\n";
  return text;
}

std::string provenance_lines(const OrderedJson& d) {
  std::string text;
  if (!d["options"].is_null()) text += "\n" + fitted("options " + d["options"].dump()) + "\n";
  text += "\nprovenance, oldest step first\n";
  for (const OrderedJson& step : d["chain"]) text += step_line(step) + assumed_lines(step);
  if (d["environment"].is_object())
    for (const auto& [key, value] : d["environment"].items())
      text += line(key.c_str(), value.is_string() ? value.get<std::string>() : value.dump());
  return text;
}

EvaluationLimits limits_of(const OrderedJson& d) {
  const FormatError refusal(d["file"].get<std::string>() +
                            ": /provenance/config_json is not a configuration of dem-eval");
  try {
    return evaluation_config(d["config"], "").limits;
  } catch (const UsageError&) {
    throw refusal;
  } catch (const nlohmann::json::exception&) {
    throw refusal;
  }
}

/// The rates of a hazard map, and whether its first site is safe.
std::string score_text(const OrderedJson& d) {
  const OrderedJson& score = d["score"];
  const OrderedJson& n = score.at("counts");
  const auto count = [&](const char* key) { return n.at(key).get<std::int64_t>(); };
  const auto rate = [&](const char* key) {
    return score.at(key).is_null() ? std::optional<double>() : score.at(key).get<double>();
  };
  std::string text = score_lines({count("safe_safe"), count("safe_hazard"), count("hazard_safe"),
                                  count("hazard_hazard"), count("unknown")},
                                 {rate("missed_hazard_frac"), rate("false_alarm_frac")}) +
                     own_table(own_verdicts_from(score));
  if (d.contains("best_site") && d["best_site"].at("true_safe").is_boolean())
    text += print("%-16s%10s   on the true terrain\n", "best site",
                  d["best_site"]["true_safe"].get<bool>() ? "safe" : "hazard");
  if (d.contains("best_site"))
    for (const std::string& place : place_lines(d["best_site"])) text += "best site at " + place + "\n";
  return text;
}

/// The result tables that the tools print.
std::string result_tables(const OrderedJson& d) {
  std::string text;
  if (d.contains("metrics")) text += "\n" + verdict_table(metrics_from(d["metrics"]), limits_of(d));
  if (d.contains("plan")) text += "\n" + plan_table(fields_from<PlanMetrics>(d["plan"]));
  if (d.contains("score")) text += score_text(d);
  return text;
}

/// A description whose texts and names can be printed, each on one line. The configuration and the options
/// are still compared and dumped; the final shown_lines() is enough for them, because JSON has no raw line
/// feeds.
OrderedJson printable(const OrderedJson& value) {
  if (value.is_string()) return shown_text(value.get<std::string>());
  if (!value.is_structured()) return value;
  OrderedJson result = value.is_array() ? OrderedJson::array() : OrderedJson::object();
  for (const auto& [key, inner] : value.items()) {
    const OrderedJson shown = key == "config" || key == "options" ? inner : printable(inner);
    if (value.is_array())
      result.push_back(shown);
    else
      result[shown_text(key)] = shown;
  }
  return result;
}

std::string text_of(const OrderedJson& d) {
  std::string text = head(d) + extent(d);
  if (d.contains("scan")) text += scan_lines(d["scan"]);
  if (d.contains("features")) text += feature_lines(d["features"]);
  for (const auto& [group, entries] : d["datasets"].items()) text += dataset_lines(group, entries);
  try {
    text += result_tables(d);
  } catch (const nlohmann::json::exception&) {
    throw FormatError(d["file"].get<std::string>() + ": /" +
                      (d.contains("plan")    ? "plan"
                       : d.contains("score") ? "score"
                                             : "metrics") +
                      "_json was not written by this version");
  }
  return text + config_lines(d) + provenance_lines(d);
}

}  // namespace

std::string description_text(const OrderedJson& description) {
  return shown_lines(text_of(printable(description)));
}

std::string config_text(const OrderedJson& description) {
  const OrderedJson& config = description.at("config");
  if (!config.is_object())
    throw FormatError(description.at("file").get<std::string>() + ": has no configuration");
  return shown_lines(config.dump(2)) + "\n";
}

}  // namespace landfall::cli
