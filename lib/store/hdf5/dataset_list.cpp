// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/hdf5/dataset_list.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "base/text/split_text.h"

namespace landfall {
namespace {

struct Member {
  haddr_t address;  ///< increases in the order of creation
  std::string name;
  H5O_type_t type;
};

herr_t add_member(hid_t group, const char* name, const H5L_info_t* link, void* list) {
  H5O_info_t info;
  if (link->type != H5L_TYPE_HARD) return 0;
  if (H5Oget_info_by_name2(group, name, &info, H5O_INFO_BASIC, H5P_DEFAULT) < 0) return -1;
  static_cast<std::vector<Member>*>(list)->push_back({info.addr, name, info.type});
  return 0;
}

std::vector<Member> members_of(hid_t group) {
  std::vector<Member> members;
  if (H5Literate(group, H5_INDEX_NAME, H5_ITER_INC, nullptr, add_member, &members) < 0)
    h5::fail_reading(group);
  std::sort(members.begin(), members.end(),
            [](const Member& a, const Member& b) { return a.address < b.address; });
  return members;
}

/// Empty for a type that is not a number.
std::string type_name(hid_t dataset) {
  const h5::Handle type(H5Dget_type(dataset), H5Tclose);
  const std::string bits = std::to_string(8 * H5Tget_size(type.get()));
  if (H5Tget_class(type.get()) == H5T_FLOAT) return "float" + bits;
  if (H5Tget_class(type.get()) != H5T_INTEGER) return "";
  return (H5Tget_sign(type.get()) == H5T_SGN_NONE ? "uint" : "int") + bits;
}

std::vector<hsize_t> extents_of(hid_t dataset) {
  const h5::Handle space(H5Dget_space(dataset), H5Sclose);
  std::vector<hsize_t> shape = h5::extent_of(space.get());
  if (shape.size() != 1 && shape.size() != 2) shape.clear();
  return shape;
}

std::optional<DatasetEntry> entry_of(hid_t group, const std::string& name) {
  DatasetEntry entry;
  entry.dataset = h5::Handle(H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose);
  if (!entry.dataset) h5::fail_reading(group, name);
  const hid_t dataset = entry.dataset.get();
  entry.name = name;
  entry.type = type_name(dataset);
  entry.shape = extents_of(dataset);
  if (entry.type.empty() || entry.shape.empty()) return std::nullopt;
  entry.units = h5::read_text_attribute(dataset, "units").value_or("");
  entry.long_name = h5::read_text_attribute(dataset, "long_name").value_or("");
  entry.flag_values = h5::read_flags_attribute(dataset, "flag_values");
  entry.flag_masks = h5::read_flags_attribute(dataset, "flag_masks");
  entry.flag_meanings = split_words(h5::read_text_attribute(dataset, "flag_meanings").value_or(""));
  entry.stored_bytes = h5::stored_bytes(dataset);
  return entry;
}

}  // namespace

double DatasetEntry::value_count() const {
  double count = 1;
  for (const hsize_t size : shape) count *= static_cast<double>(size);
  return count;
}

std::vector<DatasetEntry> list_datasets(hid_t group) {
  std::vector<DatasetEntry> entries;
  for (const Member& member : members_of(group)) {
    if (member.type != H5O_TYPE_DATASET) continue;
    if (std::optional<DatasetEntry> entry = entry_of(group, member.name))
      entries.push_back(std::move(*entry));
  }
  return entries;
}

std::vector<std::string> list_groups(hid_t group) {
  std::vector<std::string> names;
  for (const Member& member : members_of(group))
    if (member.type == H5O_TYPE_GROUP) names.push_back(member.name);
  return names;
}

}  // namespace landfall
