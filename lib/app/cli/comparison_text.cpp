// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/cli/comparison_text.h"

#include <utility>

#include "app/cli/print.h"
#include "base/geometry/map_position.h"
#include "base/text/joined.h"
#include "base/text/number_text.h"
#include "base/text/shown_text.h"

namespace landfall::cli {
namespace {

using Comparison = nlohmann::ordered_json;

/// Longer metrics are shown only where they differ.
constexpr std::size_t kShownMetrics = 200;

std::string value_text(const Comparison& value) {
  if (value.is_null()) return "-";
  if (value.is_number_integer()) return grouped(value.get<std::int64_t>());
  if (value.is_number()) return print("%.5g", value.get<double>());
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string side_text(const Comparison& entry, const char* side) {
  return entry.contains(side) ? value_text(entry[side]) : "(none)";
}

/// The conclusion, and what each requirement or number says.
std::string answer_lines(const Comparison& answer) {
  std::string text = "\n" + answer["sentence"].get<std::string>() + "\n";
  for (const Comparison& point : answer["points"])
    text += "  " + point["name"].get<std::string>() + ": " + point["text"].get<std::string>() + "\n";
  for (const Comparison& note : answer["notes"]) text += "  note: " + note.get<std::string>() + "\n";
  return text;
}

std::string configuration_lines(const Comparison& differing) {
  if (differing.empty()) return "\nconfiguration: no difference\n";
  std::string text = "\nconfiguration, where it differs: A, B\n";
  for (const Comparison& entry : differing)
    text += "  " + entry["tool"].get<std::string>() + " " + entry["key"].get<std::string>() + ": " +
            side_text(entry, "a") + ", " + side_text(entry, "b") + "\n";
  return text;
}

std::string verdict_of(const Comparison& requirement) {
  if (!requirement.is_object() || !requirement.contains("pass") || requirement["pass"].is_null())
    return "not judged";
  return requirement["pass"].get<bool>() ? "pass" : "FAIL";
}

std::string requirement_value(const Comparison& requirement) {
  return requirement.is_object() && requirement.contains("value") ? value_text(requirement["value"]) : "-";
}

std::string requirement_lines(const Comparison& all) {
  std::string text = print("\n%-24s %14s %-10s %14s %-10s\n", "requirement", "A", "", "B", "");
  for (const Comparison& entry : all)
    text += print("%-24s %14s %-10s %14s %s\n", entry["name"].get<std::string>().c_str(),
                  requirement_value(entry["a"]).c_str(), verdict_of(entry["a"]).c_str(),
                  requirement_value(entry["b"]).c_str(), verdict_of(entry["b"]).c_str());
  return text;
}

std::string metric_lines(const Comparison& metrics) {
  std::string text = print("\n%-43s %11s %11s %11s\n", "number that differs", "A", "B", "B - A");
  std::size_t shown = 0;
  for (const Comparison& entry : metrics) {
    if (entry["a"] == entry["b"] || shown == kShownMetrics) continue;
    ++shown;
    text += print("%-43s %11s %11s %11s\n", entry["metric"].get<std::string>().c_str(),
                  value_text(entry["a"]).c_str(), value_text(entry["b"]).c_str(),
                  value_text(entry["difference"]).c_str());
  }
  return shown == 0 ? "\nnumbers: no difference\n" : text;
}

/// The name of a layer and its unit, on a line of their own if the table has no room for them.
std::string layer_title(const Comparison& layer) {
  const std::string unit = layer["unit"].get<std::string>();
  const std::string title =
      layer["layer"].get<std::string>() + (unit.empty() || unit == "1" ? "" : ", " + unit);
  constexpr std::size_t kWidth = 15;
  return title.size() <= kWidth ? print("%-15s", title.c_str()) : title + "\n" + std::string(kWidth, ' ');
}

std::string layer_lines(const Comparison& layers) {
  std::string text = print("\n%-15s %10s %8s %8s %8s %8s %8s %8s\n", "layer, B - A", "in both", "mean", "std",
                           "NMAD", "5 %", "50 %", "95 %");
  for (const Comparison& layer : layers) {
    const std::string name = layer["layer"].get<std::string>();
    if (layer.contains("differing")) {
      text += print("%-18s %s of %s bins differ\n", name.c_str(), value_text(layer["differing"]).c_str(),
                    value_text(layer["bins"]).c_str());
      continue;
    }
    text += layer_title(layer) + print(" %10s", value_text(layer["valid_both"]).c_str());
    for (const char* const key : {"mean", "std", "nmad", "p05", "p50", "p95"})
      text += print(" %8s", layer[key].is_null() ? "-" : statistic_text(layer[key].get<double>()).c_str());
    text += "\n";
  }
  return text;
}

std::string pair_lines(const Comparison& json) {
  std::string text = print("\n%-19s %4s %6s %6s %7s %9s %s\n", "draws that pass", "both", "only A", "only B",
                           "neither", "McNemar p", "B - A, 95 % interval");
  for (const Comparison& pair : json) {
    const Comparison& difference = pair["difference"];
    if (pair["both"] == 0 && pair["only_a"] == 0 && pair["only_b"] == 0 && pair["neither"] == 0) {
      text += print("%-19s not judged\n", pair["name"].get<std::string>().c_str());
      continue;
    }
    text += print("%-19s %4s %6s %6s %7s %9.2g %.3f, %.3f to %.3f\n", pair["name"].get<std::string>().c_str(),
                  value_text(pair["both"]).c_str(), value_text(pair["only_a"]).c_str(),
                  value_text(pair["only_b"]).c_str(), value_text(pair["neither"]).c_str(),
                  pair["mcnemar_p"].get<double>(), difference["value"].get<double>(),
                  difference["low"].get<double>(), difference["high"].get<double>());
  }
  return text;
}

/// The draws with the same random numbers in both runs.
std::string draw_lines(const Comparison& json) {
  const Comparison& draws = json["draws"];
  std::string text = "\n" + value_text(draws["common"]) + " draws in common, of " + value_text(draws["a"]) +
                     " in A and " + value_text(draws["b"]) + " in B: same seed and number\n";
  if (!json.contains("pairs")) return text + "no outcome is compared in pairs\n";
  if (!json["differing_keys"].empty())
    text +=
        "their values of " +
        joined(json["differing_keys"], ", ", [](const Comparison& key) { return key.get<std::string>(); }) +
        " differ\n";
  return text + pair_lines(json["pairs"]);
}

std::string side_line(const char* name, const Comparison& side) {
  return std::string(name) + "  " + side["file"].get<std::string>() + "  file id " +
         side["file_id"].get<std::string>() + "\n";
}

/// "centre 500000, 5400000 of WGS 84 / UTM zone 32N".
std::string place_text(const Comparison& place) {
  const auto number = [](const Comparison& value) {
    return value.is_null() ? std::string("not known") : print("%.10g", value.get<double>());
  };
  std::string text = "centre " + number(place["center"][0]) + ", " + number(place["center"][1]);
  text += place["map"].is_null() ? ", no CRS" : " of " + place["map"].get<std::string>();
  if (place["height_m"].is_null() || place["height_m"] != 0) text += ", height " + number(place["height_m"]);
  return text + (place["vertical_datum"].is_null() ? "" : ", " + place["vertical_datum"].get<std::string>());
}

std::string meeting_text(const Comparison& a, const Comparison& b, const Comparison& json) {
  std::string text = "\nplace: A " + place_text(a["place"]) + "\n       B " + place_text(b["place"]) + "\n";
  for (const Comparison& said : json["placement"]["said"]) text += "  B " + said.get<std::string>() + "\n";
  if (json.contains("not_compared"))
    return text + (json["kind"] == "scan" ? "returns" : "layers") +
           " are not compared: " + json["not_compared"].get<std::string>() + "\n";
  if (!json.contains("common_bins")) return text;
  const Comparison& bins = json["common_bins"];
  return text + "bins in common: " + value_text(bins["columns"]) + " x " + value_text(bins["rows"]) +
         print(", x %.10g to %.10g m, y %.10g to %.10g m\n", bins["x_m"][0].get<double>(),
               bins["x_m"][1].get<double>(), bins["y_m"][0].get<double>(), bins["y_m"][1].get<double>());
}

std::string return_lines(const Comparison& returns) {
  std::string text =
      print("\nreturns in it; ranges and z_est in metres\n%6s %5s %8s %-12s %10s %9s %9s %6s %6s\n", "pulse",
            "pixel", "t, s", "status", "range true", "measured", "z_est", "weight", "share");
  const auto fixed = [](const Comparison& value, int digits) {
    return value.is_null() ? std::string("-") : print("%.*f", digits, value.get<double>());
  };
  for (const Comparison& point : returns)
    text += print("%6s %5s %8s %-12s %10s %9s %9s %6s %6s\n", value_text(point["pulse"]).c_str(),
                  value_text(point["pixel"]).c_str(), fixed(point["t_s"], 6).c_str(),
                  point["status"].get<std::string>().c_str(), fixed(point["range_true_m"], 4).c_str(),
                  fixed(point["range_measured_m"], 4).c_str(), fixed(point["z_est_m"], 4).c_str(),
                  fixed(point["weight"], 4).c_str(), fixed(point["share"], 4).c_str());
  return returns.empty() ? "\nno return of the scan lies in this bin\n" : text;
}

}  // namespace

std::vector<std::string> place_lines(const nlohmann::ordered_json& place) {
  std::vector<std::string> lines;
  std::string unit;
  for (const MapCoordinate& coordinate : kMapCoordinates) {
    if (!place.contains(coordinate.key) || !place.at(coordinate.key).is_number()) continue;
    const bool is_length = std::string(coordinate.units) == "m";
    const std::string text = coordinate.column + print(is_length ? " %.2f m" : " %.7f deg",
                                                       place.at(coordinate.key).get<double>());
    const std::string of = is_length ? "m" : "deg";
    if (of == std::exchange(unit, of))
      lines.back() += ", " + text;
    else
      lines.push_back(text);
  }
  return lines;
}

std::string comparison_text(const Comparison& json) {
  std::string text = "two files of kind " + json["kind"].get<std::string>() +
                     (json["same_file_id"].get<bool>() ? ", made in the same way\n" : "\n") +
                     side_line("A", json["a"]) + side_line("B", json["b"]);
  if (json["answer"].is_object()) text += answer_lines(json["answer"]);
  text += configuration_lines(json["configuration"]);
  if (json.contains("requirements")) text += requirement_lines(json["requirements"]);
  if (json.contains("metrics")) text += metric_lines(json["metrics"]);
  if (json.contains("draws")) text += draw_lines(json);
  if (json.contains("placement")) text += meeting_text(json["a"], json["b"], json);
  if (json.contains("layers")) text += layer_lines(json["layers"]);
  return shown_lines(text);
}

std::string bin_text(const Comparison& bin) {
  std::string text = bin["file"].get<std::string>() + ": the bin at x " +
                     print("%.10g", bin["x_m"].get<double>()) + " m, y " +
                     print("%.10g", bin["y_m"].get<double>()) + " m (row " + value_text(bin["row"]) +
                     ", column " + value_text(bin["column"]) + "; " +
                     print("%g", bin["resolution_m"].get<double>()) + " m wide)\n";
  for (const std::string& place : place_lines(bin)) text += "  " + place + "\n";
  text += "\n";
  for (const auto& [layer, value] : bin["layers"].items()) {
    const std::string unit = bin["units"][layer].get<std::string>();
    const std::string number =
        value.is_number_float() ? print("%.8g", value.get<double>()) : value_text(value);
    text += print("  %-16s %s%s\n", layer.c_str(), number.c_str(),
                  unit.empty() || unit == "1" || value.is_null() ? "" : (" " + unit).c_str());
  }
  if (bin.contains("returns")) text += return_lines(bin["returns"]);
  return shown_lines(text);
}

}  // namespace landfall::cli
