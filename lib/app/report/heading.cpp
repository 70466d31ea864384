// SPDX-License-Identifier: GPL-3.0-or-later
#include "app/report/heading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <span>
#include <vector>

#include "base/text/joined.h"

namespace landfall::html_report {
namespace {

/// The value at a path; null where the steps have another structure.
nlohmann::json at(const nlohmann::json& object, const std::string& path) {
  const nlohmann::json::json_pointer pointer(path);
  return object.is_structured() && object.contains(pointer) ? object.at(pointer) : nlohmann::json();
}

/// The configuration of the last step of a tool.
nlohmann::json config_of(const nlohmann::json& steps, const std::string& tool) {
  nlohmann::json config;
  for (const nlohmann::json& step : steps)
    if (at(step, "/tool") == tool) config = at(step, "/config");
  return config;
}

std::string number(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

std::string length(double metres) {
  return std::abs(metres) < 1 ? number(100 * metres) + " cm" : number(metres) + " m";
}

/// "golombek rocks" of "golombek_rocks".
std::string words(std::string name) {
  std::ranges::replace(name, '_', ' ');
  return name;
}

void add_new(std::vector<std::string>& parts, const std::string& part) {
  if (std::ranges::find(parts, part) == parts.end()) parts.push_back(part);
}

/// A raster has the name of its file, other ground that of its type.
std::vector<std::string> base_parts(const nlohmann::json& base) {
  std::vector<std::string> parts;
  const nlohmann::json list = base.is_array() ? base : nlohmann::json::array({base});
  for (const nlohmann::json& part : list) {
    const nlohmann::json type = at(part, "/type");
    const nlohmann::json path = at(part, "/path");
    if (path.is_string())
      parts.insert(parts.begin(), path.get<std::string>());
    else if (type.is_string())
      parts.push_back(type == "plane" ? "plane" : words(type) + " relief");
  }
  return parts;
}

std::vector<std::string> objects_of(const nlohmann::json& config) {
  std::vector<std::string> parts;
  for (const nlohmann::json& pattern : at(config, "/patterns")) {
    const nlohmann::json type = at(pattern, "/type");
    const nlohmann::json feature = at(pattern, "/feature/type");
    if (feature.is_string())
      add_new(parts, words(feature) + " features");
    else if (type.is_string())
      add_new(parts, words(type));
  }
  for (const nlohmann::json& feature : at(config, "/features"))
    if (at(feature, "/type").is_string()) add_new(parts, words(at(feature, "/type")) + " features");
  return parts;
}

std::string site_of(const nlohmann::json& terrain) {
  std::vector<std::string> parts = base_parts(at(terrain, "/base"));
  const std::vector<std::string> objects = objects_of(terrain);
  parts.insert(parts.end(), objects.begin(), objects.end());
  if (parts.size() < 2) return joined(parts);
  const std::string first = joined(std::span(parts).subspan(1, parts.size() - 2));
  return parts[0] + " with " + first + (first.empty() ? "" : " and ") + parts.back();
}

std::string terrain_in_numbers(const nlohmann::json& terrain) {
  const nlohmann::json half = at(terrain, "/grid/half_width_m");
  const nlohmann::json step = at(terrain, "/grid/resolution_m");
  if (!half.is_number() || !step.is_number()) return "";
  const std::string side = number(2 * half.get<double>());
  return side + " x " + side + " m of terrain at " + length(step);
}

std::string scan_in_numbers(const nlohmann::json& scan) {
  const nlohmann::json rows = at(scan, "/detector/rows");
  const nlohmann::json columns = at(scan, "/detector/columns");
  const nlohmann::json rate = at(scan, "/laser/pulse_rate_hz");
  const nlohmann::json time = at(scan, "/laser/scan_time_s");
  if (!rows.is_number() || !columns.is_number() || !rate.is_number() || !time.is_number()) return "";
  std::string text = number(time) + " s of pulses of " + number(columns) + " x " + number(rows) +
                     " pixels at " +
                     (rate < 1000 ? number(rate) + " Hz" : number(rate.get<double>() / 1000) + " kHz");
  const nlohmann::json height = at(scan, "/trajectory/position_m/2");
  if (height.is_number()) text += " from " + number(height) + " m";
  const nlohmann::json sigma = at(scan, "/noise/range_sigma_m");
  if (sigma.is_number()) text += ", range noise of " + length(sigma) + " (1 sigma)";
  return text;
}

}  // namespace

std::string title_of(const nlohmann::json& steps, const std::string& otherwise) {
  std::vector<std::string> parts;
  const std::string site = site_of(config_of(steps, "terrain-gen"));
  if (!site.empty()) parts.push_back(site);
  const nlohmann::json source = at(config_of(steps, "landfall-import"), "/source");
  if (source.is_string()) parts.push_back(source.get<std::string>());
  const nlohmann::json scanner = at(config_of(steps, "scan-sim"), "/scanner/type");
  if (scanner.is_string()) parts.push_back(words(scanner) + " scanner");
  return parts.empty() ? otherwise : joined(parts);
}

std::string origin_of(const nlohmann::json& steps) {
  std::vector<std::string> parts;
  for (const std::string& part :
       {terrain_in_numbers(config_of(steps, "terrain-gen")), scan_in_numbers(config_of(steps, "scan-sim"))})
    if (!part.empty()) parts.push_back(part);
  const nlohmann::json source = at(config_of(steps, "landfall-import"), "/source");
  const nlohmann::json format = at(config_of(steps, "landfall-import"), "/format");
  if (source.is_string() && format.is_string())
    parts.push_back("imported from " + source.get<std::string>() + " (" + format.get<std::string>() + ")");
  const nlohmann::json bin = at(config_of(steps, "regrid"), "/resolution_m");
  if (bin.is_number()) parts.push_back("bins of " + length(bin));
  return joined(parts, "; ");
}

}  // namespace landfall::html_report
