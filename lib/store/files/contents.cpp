// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/contents.h"

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>

#include "base/core/error.h"
#include "base/dictionary/layers.h"
#include "base/returns/columns.h"

namespace landfall {
namespace {

constexpr std::array kSiteOrder = {
    "rank", "x",           "y",      "easting",  "northing", "latitude",  "longitude",          "z",
    "cost", "p_touchdown", "p_safe", "p_capped", "slope",    "roughness", "distance_to_hazard", "true_safe"};

constexpr auto kColumnOrder =
    std::apply([](const auto&... column) { return std::array{column.name...}; }, kPointColumns);

/// Puts the names of `order` first, as there, and sorts the others.
void sort_by(std::span<const char* const> order, std::vector<ContentInfo>& contents) {
  const auto rank = [&](const ContentInfo& content) {
    const auto found = std::find(order.begin(), order.end(), std::string_view(content.name));
    return std::pair(found - order.begin(), std::string_view(content.name));
  };
  std::ranges::sort(contents, {}, rank);
}

std::optional<h5::Type> integer_type(std::size_t size, bool is_signed) {
  if (!is_signed) size *= 2;
  if (size == 1) return h5::Type::int8;
  if (size <= 4) return h5::Type::int32;
  if (size == 8) return h5::Type::int64;
  return std::nullopt;
}

std::optional<h5::Type> column_type(hid_t dataset) {
  const h5::Handle type(H5Dget_type(dataset), H5Tclose);
  const std::size_t size = H5Tget_size(type.get());
  switch (H5Tget_class(type.get())) {
    case H5T_FLOAT:
      if (size > 8) return std::nullopt;
      return size <= 4 ? h5::Type::float32 : h5::Type::float64;
    case H5T_INTEGER:
      return integer_type(size, H5Tget_sign(type.get()) == H5T_SGN_2);
    default:
      return std::nullopt;
  }
}

bool is_plain(std::string_view name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

/// Texts of a foreign file may be copied into headers of other formats, which consist of lines.
std::string text_of(hid_t dataset, const char* attribute) {
  std::string text = h5::read_text_attribute(dataset, attribute).value_or("");
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
  return text;
}

/// A group, and the prefix of messages about its content: "file: /group/".
struct NamedGroup {
  hid_t group;
  std::string name;
};

[[noreturn]] void fail_reading(const std::string& what) {
  throw FormatError(what + " cannot be read: " + h5::reading_failure());
}

std::vector<std::string> names_in(const NamedGroup& group) {
  H5G_info_t info{};
  if (H5Gget_info(group.group, &info) < 0) fail_reading(group.name);
  std::vector<std::string> names;
  for (hsize_t i = 0; i < info.nlinks; ++i) {
    std::array<char, 256> name{};
    const ssize_t length = H5Lget_name_by_idx(group.group, ".", H5_INDEX_NAME, H5_ITER_INC, i, name.data(),
                                              name.size(), H5P_DEFAULT);
    if (length < 0) fail_reading(group.name);
    if (static_cast<std::size_t>(length) < name.size() && is_plain(name.data()))
      names.emplace_back(name.data());
  }
  return names;
}

/// The numeric datasets of a group whose extent satisfies `wanted`, sorted by `order`. A dataset that cannot
/// be opened is an error, because an export would silently omit it.
std::vector<ContentInfo> datasets(const NamedGroup& group, std::span<const char* const> order,
                                  const std::function<bool(std::span<const hsize_t>)>& wanted) {
  std::vector<ContentInfo> result;
  for (const std::string& name : names_in(group)) {
    const h5::Handle object(H5Oopen(group.group, name.c_str(), H5P_DEFAULT), H5Oclose);
    if (!object) fail_reading(group.name + name);
    if (H5Iget_type(object.get()) != H5I_DATASET) continue;
    const h5::Handle space(H5Dget_space(object.get()), H5Sclose);
    const std::optional<h5::Type> type = column_type(object.get());
    if (!type || !wanted(h5::extent_of(space.get()))) continue;
    result.push_back({name, *type, text_of(object.get(), "units"), text_of(object.get(), "long_name")});
  }
  sort_by(order, result);
  return result;
}

std::vector<ContentInfo> columns(const TableReader& table, std::span<const char* const> order) {
  return datasets({table.group(), table.file() + ": " + table.path_of("")}, order,
                  [](std::span<const hsize_t> size) { return size.size() == 1; });
}

}  // namespace

bool is_class(const ContentInfo& content) {
  return content.type == h5::Type::int8 || content.name == "hole_id";
}

std::string name_with_unit(const ContentInfo& content) {
  const bool plain = !content.units.empty() && content.units != "1" &&
                     std::all_of(content.units.begin(), content.units.end(),
                                 [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); });
  const std::string unit =
      "_" + (content.units == "degree" ? std::string("deg") : content.units);  // as in JSON
  return !plain || content.name.ends_with(unit) ? content.name : content.name + unit;
}

std::string kind_of(const LandfallFileReader& file) {
  const std::string prefix = "landfall.";
  return h5::read_text_attribute(file.root(), "format_name").value_or(prefix).substr(prefix.size());
}

bool has_grid(const LandfallFileReader& file) {
  return h5::exists(file.root(), "x") && h5::exists(file.root(), "y");
}

std::vector<ContentInfo> layers_of(const LandfallFileReader& file, const GridSpec& spec) {
  return datasets({file.root(), file.name() + ": /"}, dictionary::layer_names(),
                  [&spec](std::span<const hsize_t> size) {
                    return size.size() == 2 && size[0] == static_cast<hsize_t>(spec.rows) &&
                           size[1] == static_cast<hsize_t>(spec.cols);
                  });
}

std::vector<ContentInfo> columns_of(const TableReader& points) { return columns(points, kColumnOrder); }

std::vector<ContentInfo> site_columns_of(const TableReader& sites) { return columns(sites, kSiteOrder); }

}  // namespace landfall
