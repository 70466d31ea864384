// SPDX-License-Identifier: GPL-3.0-or-later
#include "chain/terrain/site_wkt.h"

#include <algorithm>
#include <charconv>
#include <string_view>
#include <system_error>

namespace landfall {
namespace {

constexpr std::string_view kRemark = ",REMARK[\"";
constexpr std::string_view kRemarkEnd = "\"]]";
constexpr std::string_view kCenter = "center: ";
constexpr std::string_view kMap = "map: ";

/// The text of the remark that ends a WKT; empty: none of ours.
std::string_view remark_of(std::string_view wkt) {
  const std::size_t begin = wkt.rfind(kRemark);
  if (begin == std::string_view::npos || !wkt.ends_with(kRemarkEnd)) return {};
  wkt.remove_prefix(begin + kRemark.size());
  wkt.remove_suffix(kRemarkEnd.size());
  return wkt.starts_with(kCenter) || wkt.starts_with(kMap) ? wkt : std::string_view();
}

std::string replaced(std::string text, char from, char to) {
  std::ranges::replace(text, from, to);
  return text;
}

std::string quoted(const std::string& text) { return replaced(replaced(text, '\'', '`'), '"', '\''); }
std::string unquoted(std::string_view text) {
  return replaced(replaced(std::string(text), '\'', '"'), '`', '\'');
}

/// The text between a label and the next separator; empty: no such label.
std::string_view part_after(std::string_view remark, std::string_view label, char separator = ';') {
  const std::size_t at = remark.find(label);
  if (at == std::string_view::npos) return {};
  remark.remove_prefix(at + label.size());
  return remark.substr(0, remark.find(separator));
}

bool read_number(std::string_view& text, double& number) {
  while (text.starts_with(' ') || text.starts_with(',')) text.remove_prefix(1);
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc();
}

}  // namespace

std::string coordinate_text(double number) {
  std::array<char, 512> text{};
  return {text.data(),
          std::to_chars(text.data(), text.data() + text.size(), number, std::chars_format::fixed).ptr};
}

std::string with_place(const std::string& site_wkt, const MapPlace& place) {
  std::string wkt = without_place(site_wkt);
  if (!wkt.ends_with(']')) return site_wkt;
  wkt.pop_back();
  wkt += kRemark;
  wkt += kCenter;
  wkt += coordinate_text(place.center[0]) + ", " + coordinate_text(place.center[1]) + ", " +
         coordinate_text(place.center[2]) + "; unit: " + coordinate_text(place.metres_per_unit);
  if (!place.vertical.empty()) wkt += "; heights: " + quoted(replaced(place.vertical, ';', ','));
  if (!place.map_wkt.empty()) wkt += "; map: " + quoted(place.map_wkt);
  return wkt.append(kRemarkEnd);
}

std::optional<MapPlace> place_of(const std::string& site_wkt) {
  const std::string_view remark = remark_of(site_wkt);
  if (!remark.starts_with(kCenter)) return std::nullopt;
  MapPlace place{.center = {}, .metres_per_unit = 1, .vertical = {}, .map_wkt = map_wkt_of(site_wkt)};
  std::string_view center = part_after(remark, kCenter);
  for (double& coordinate : place.center)
    if (!read_number(center, coordinate)) return std::nullopt;
  const std::string_view before_map = remark.substr(0, remark.find(kMap));
  std::string_view unit = part_after(before_map, "unit: ");
  if (!read_number(unit, place.metres_per_unit)) return std::nullopt;
  place.vertical = unquoted(part_after(before_map, "heights: "));
  return place;
}

std::string raised(const std::string& site_wkt, double height_m) {
  std::optional<MapPlace> place = place_of(site_wkt);
  if (!place) return site_wkt;
  place->center[2] += height_m;
  return with_place(site_wkt, *place);
}

std::string map_wkt_of(const std::string& site_wkt) {
  const std::string_view remark = remark_of(site_wkt);
  const std::size_t at = remark.find(kMap);
  return at == std::string_view::npos ? "" : unquoted(remark.substr(at + kMap.size()));
}

MapPlace unplaced(const std::string& site_wkt) {
  MapPlace place;
  place.map_wkt = map_wkt_of(site_wkt);
  return place;
}

std::string without_place(const std::string& site_wkt) {
  const std::string_view remark = remark_of(site_wkt);
  return remark.empty()
             ? site_wkt
             : site_wkt.substr(0, site_wkt.size() - remark.size() - kRemark.size() - kRemarkEnd.size()) + "]";
}

}  // namespace landfall
