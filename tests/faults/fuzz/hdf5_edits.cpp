// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_edits.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "hdf5_values.h"
#include "store/hdf5/h5.h"

namespace landfall::fuzz {
namespace {

using Json = nlohmann::json;
using h5::Handle;

constexpr int kMaxEdits = 8;

/// The file on which an edit works.
struct Scene {
  hid_t file;
  const LandfallFile& original;
  InputBytes& input;

  [[nodiscard]] const std::string& object() const {
    return original.objects[input.below(original.objects.size())];
  }
  /// Mostly a path of the file, at times one of another.
  [[nodiscard]] std::string path() const {
    if (input.below(8) != 0) return object();
    const LandfallFile& other = landfall_files()[input.below(landfall_files().size())];
    return other.objects[input.below(other.objects.size())];
  }
  [[nodiscard]] Handle open(const std::string& path) const {
    return {H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose};
  }
  /// Not a dataset: none.
  [[nodiscard]] Handle open_dataset(const std::string& path) const {
    return {H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose};
  }
};

void remove_object(const Scene& s) { H5Ldelete(s.file, s.object().c_str(), H5P_DEFAULT); }

void move_object(const Scene& s) {
  const std::string from = s.object();
  H5Lmove(s.file, from.c_str(), s.file, s.path().c_str(), H5P_DEFAULT, H5P_DEFAULT);
}

/// The extent of a dataset; empty where there is none.
std::vector<hsize_t> extent_of(hid_t dataset) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const int rank = space ? H5Sget_simple_extent_ndims(space.get()) : 0;
  std::vector<hsize_t> extent(static_cast<std::size_t>(std::max(rank, 0)));
  if (!extent.empty()) H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr);
  return extent;
}

void fill(hid_t dataset, InputBytes& input) {
  const Handle space(H5Dget_space(dataset), H5Sclose);
  const hssize_t count = H5Sget_simple_extent_npoints(space.get());
  if (count < 1 || count > 4096) return;
  const std::vector<double> values = ramp(static_cast<std::size_t>(count), input);
  H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

/// A dataset of another type, shape or storage in the place of an object, or in a new one.
void replace(const Scene& s) {
  const std::string path = s.path();
  const Handle old = s.open_dataset(path);
  const Handle old_type(old ? H5Dget_type(old.get()) : H5I_INVALID_HID, H5Tclose);
  const std::vector<hsize_t> old_extent = old ? extent_of(old.get()) : std::vector<hsize_t>();
  const bool keeps_type = s.input.below(2) == 0 && old_type;
  const Handle type = keeps_type ? Handle(H5Tcopy(old_type.get()), H5Tclose) : any_type(s.input);
  const Shape shape = any_shape(old_extent, s.input);
  const Handle storage = any_storage(shape, s.input);
  H5Ldelete(s.file, path.c_str(), H5P_DEFAULT);
  const Handle dataset(H5Dcreate2(s.file, path.c_str(), type.get(), shape.space.get(), H5P_DEFAULT,
                                  storage.get(), H5P_DEFAULT),
                       H5Dclose);
  if (dataset && s.input.below(4) != 0) fill(dataset.get(), s.input);
}

/// One value of a dataset.
void poke(const Scene& s) {
  const Handle dataset = s.open_dataset(s.object());
  if (!dataset) return;
  std::vector<hsize_t> at = extent_of(dataset.get());
  if (at.empty()) return;
  for (hsize_t& index : at) index = s.input.below(static_cast<std::size_t>(std::min<hsize_t>(index, 65536)));
  const Handle space(H5Dget_space(dataset.get()), H5Sclose);
  const Handle one(H5Screate(H5S_SCALAR), H5Sclose);
  const double value = any_number(s.input);
  if (H5Sselect_elements(space.get(), H5S_SELECT_SET, 1, at.data()) >= 0)
    H5Dwrite(dataset.get(), H5T_NATIVE_DOUBLE, one.get(), space.get(), H5P_DEFAULT, &value);
}

/// Object and name of an attribute of the file, or a known name on any object.
std::pair<std::string, std::string> any_attribute(const Scene& s) {
  auto attribute = s.original.attributes.empty()
                       ? std::pair<std::string, std::string>("/", "format_name")
                       : s.original.attributes[s.input.below(s.original.attributes.size())];
  if (s.input.below(4) == 0) attribute.first = s.object();
  return attribute;
}

void remove_attribute(const Scene& s) {
  const auto [path, name] = any_attribute(s);
  H5Adelete_by_name(s.file, path.c_str(), name.c_str(), H5P_DEFAULT);
}

void set_attribute(const Scene& s) {
  const auto [path, name] = any_attribute(s);
  const Handle object = s.open(path);
  if (!object) return;
  const Handle type = any_type(s.input);
  const Shape shape = any_shape({}, s.input);
  H5Adelete(object.get(), name.c_str());
  const Handle attribute(
      H5Acreate2(object.get(), name.c_str(), type.get(), shape.space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (attribute && shape.count > 0 && shape.count <= 4096)
    H5Awrite(attribute.get(), H5T_NATIVE_DOUBLE, ramp(shape.count, s.input).data());
}

void write_text(hid_t target, const std::string& text, bool is_attribute) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const char* const data = text.c_str();
  if (is_attribute)
    H5Awrite(target, type.get(), static_cast<const void*>(&data));
  else
    H5Dwrite(target, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, static_cast<const void*>(&data));
}

/// Another text, of variable or fixed length.
void set_text_attribute(const Scene& s) {
  const auto [path, name] = any_attribute(s);
  const Handle object = s.open(path);
  if (!object) return;
  const std::string text = any_text(s.input);
  const bool fixed = s.input.below(4) == 0 && !text.empty();
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), fixed ? text.size() : H5T_VARIABLE);
  if (!fixed) H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  H5Adelete(object.get(), name.c_str());
  const Handle attribute(
      H5Acreate2(object.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute) return;
  if (fixed)
    H5Awrite(attribute.get(), type.get(), text.data());
  else
    write_text(attribute.get(), text, true);
}

void link(const Scene& s) {
  const std::string to = s.object();
  const std::string at = s.path();
  H5Ldelete(s.file, at.c_str(), H5P_DEFAULT);
  switch (s.input.below(3)) {
    case 0:
      H5Lcreate_hard(s.file, to.c_str(), s.file, at.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    case 1:
      H5Lcreate_soft(to.c_str(), s.file, at.c_str(), H5P_DEFAULT, H5P_DEFAULT);
      break;
    default:
      H5Lcreate_external("/nonexistent/landfall.h5", to.c_str(), s.file, at.c_str(), H5P_DEFAULT,
                         H5P_DEFAULT);
  }
}

/// A group or a named type where something else is expected.
void put_other_object(const Scene& s) {
  const std::string path = s.path();
  H5Ldelete(s.file, path.c_str(), H5P_DEFAULT);
  if (s.input.below(2) == 0) {
    const Handle group(H5Gcreate2(s.file, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
  } else {
    const Handle type = any_type(s.input);
    H5Tcommit2(s.file, path.c_str(), type.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  }
}

/// Other bytes, or other flags, for the first chunk.
void overwrite_chunk(const Scene& s) {
  const Handle dataset = s.open_dataset(s.object());
  if (!dataset) return;
  const std::array<hsize_t, H5S_MAX_RANK> first = {};
  hsize_t size = 0;
  if (H5Dget_chunk_storage_size(dataset.get(), first.data(), &size) < 0 || size == 0 || size > 65536) return;
  std::vector<std::uint8_t> bytes(size);
  std::uint32_t mask = 0;
  if (H5Dread_chunk(dataset.get(), H5P_DEFAULT, first.data(), &mask, bytes.data()) < 0) return;
  if (s.input.below(4) == 0) mask = s.input.byte() & 3U;
  if (s.input.below(4) == 0) bytes.resize(1 + s.input.below(2 * bytes.size()));
  for (std::size_t n = s.input.below(4); n > 0; --n) bytes[s.input.below(bytes.size())] = s.input.byte();
  H5Dwrite_chunk(dataset.get(), H5P_DEFAULT, mask, first.data(), bytes.size(), bytes.data());
}

void resize(const Scene& s) {
  const Handle dataset = s.open_dataset(s.object());
  if (!dataset) return;
  std::vector<hsize_t> extent = extent_of(dataset.get());
  if (extent.empty()) return;
  extent[s.input.below(extent.size())] = any_size(s.input);
  H5Dset_extent(dataset.get(), extent.data());
}

/// The texts of JSON in a file.
std::vector<std::string> json_texts(const LandfallFile& original) {
  std::vector<std::string> paths;
  std::copy_if(original.objects.begin(), original.objects.end(), std::back_inserter(paths),
               [](const std::string& path) { return path.ends_with("_json"); });
  return paths;
}

void count_values(const Json& value, std::size_t& count) {
  ++count;
  if (value.is_structured())
    for (const Json& element : value) count_values(element, count);
}

/// The value of this number, counted depth first.
Json* find_value(Json& value, std::size_t& number) {
  if (number-- == 0) return &value;
  if (value.is_structured())
    for (Json& element : value)
      if (Json* const found = find_value(element, number)) return found;
  return nullptr;
}

void replace_json_value(const Scene& s) {
  const std::vector<std::string> paths = json_texts(s.original);
  if (paths.empty()) return;
  const std::string& path = paths[s.input.below(paths.size())];
  const Handle dataset = s.open_dataset(path);
  const std::optional<std::string> text = dataset ? h5::read_text(s.file, path) : std::nullopt;
  if (!text) return;
  Json json = Json::parse(*text, nullptr, false);
  if (json.is_discarded()) return;
  std::size_t count = 0;
  count_values(json, count);
  std::size_t number = s.input.below(count);
  Json* const value = find_value(json, number);
  const std::size_t what = s.input.below(4);
  if (what == 0)
    *value = Json::array({*value});
  else if (what == 1)
    *value = Json::parse(any_text(s.input), nullptr, false);
  else if (value->is_structured() && !value->empty())
    value->erase(value->begin());
  else
    *value = any_number(s.input);
  if (!json.is_discarded())
    write_text(dataset.get(), json.dump(-1, ' ', false, Json::error_handler_t::replace), false);
}

void replace_json_text(const Scene& s) {
  const std::vector<std::string> paths = json_texts(s.original);
  if (paths.empty()) return;
  const Handle dataset = s.open_dataset(paths[s.input.below(paths.size())]);
  if (dataset) write_text(dataset.get(), any_text(s.input), false);
}

constexpr std::array kEdits = {remove_object,
                               move_object,
                               replace,
                               poke,
                               replace,
                               poke,
                               remove_attribute,
                               set_attribute,
                               link,
                               set_text_attribute,
                               put_other_object,
                               overwrite_chunk,
                               resize,
                               replace_json_value,
                               replace_json_text};

}  // namespace

void edit(hid_t file, const LandfallFile& original, InputBytes& input) {
  for (int i = 0; i < kMaxEdits && !input.at_end(); ++i)
    kEdits[input.below(kEdits.size())](Scene{file, original, input});
}

}  // namespace landfall::fuzz
