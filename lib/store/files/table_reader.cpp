// SPDX-License-Identifier: GPL-3.0-or-later
#include "store/files/table_reader.h"

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/core/error.h"
#include "base/core/mapped.h"
#include "base/text/file_path.h"
#include "base/text/shown_text.h"
#include "store/files/table_columns.h"
#include "store/files/text_table.h"
#include "store/hdf5/dataset_list.h"

namespace landfall {
namespace {

/// A group of an HDF5 file, and its datasets of numbers.
struct TableGroup {
  std::string path;  ///< "/" or "/a/b"
  std::vector<DatasetEntry> columns;

  [[nodiscard]] std::vector<std::string> names() const { return mapped(columns, &DatasetEntry::name); }
};

/// The root and, unless it has the columns, the groups below it. A group that is in two places is listed
/// twice; depth and number are limited.
std::vector<TableGroup> groups_of(hid_t root, const TableColumns& wanted) {
  constexpr std::size_t kMaxGroups = 1000;
  constexpr int kDeepest = 4;
  std::vector<TableGroup> groups;
  const std::function<void(hid_t, const std::string&, int)> visit = [&](hid_t group, const std::string& path,
                                                                        int level) {
    if (groups.size() == kMaxGroups) return;
    groups.push_back({path.empty() ? "/" : path, list_datasets(group)});
    if (level == kDeepest || has_columns(groups.front().names(), wanted)) return;
    for (const std::string& name : list_groups(group))
      visit(h5::open_group(group, name).get(), path + "/" + name, level + 1);
  };
  visit(root, "", 0);
  return groups;
}

/// The root if it has the columns, else the only group that has them.
const TableGroup& group_of(const std::vector<TableGroup>& groups, const TableColumns& wanted,
                           const std::string& name) {
  std::vector<const TableGroup*> found;
  for (const TableGroup& group : groups)
    if (has_columns(group.names(), wanted)) found.push_back(&group);
  if (found.empty() || found.front() == &groups.front()) return groups.front();
  if (found.size() > 1)
    throw FormatError(name + ": the groups " + found[0]->path + " and " + found[1]->path +
                      " both have the columns; copy one of them to the root");
  return *found.front();
}

/// A dataset of the shape (N), (N, 1) or (1, N), as MATLAB writes vectors.
std::vector<double> values_of(const DatasetEntry& column, const TableGroup& group, const std::string& file) {
  const std::string path = (group.path == "/" ? "" : group.path) + "/" + column.name;
  const std::vector<hsize_t>& shape = column.shape;
  if (shape.size() == 2 && shape[0] != 1 && shape[1] != 1)
    throw FormatError(file + ": " + path + " has the shape (" + std::to_string(shape[0]) + ", " +
                      std::to_string(shape[1]) + "); a column has (N), (N, 1) or (1, N)");
  std::vector<double> values(static_cast<std::size_t>(column.value_count()));
  if (!h5::read_values(column.dataset.get(), H5T_NATIVE_DOUBLE, values.data()))
    throw FormatError(file + ": reading " + path + " failed: " + h5::reading_failure());
  return values;
}

/// Refuses a wanted column that is there as something else: text, a scalar, more than two dimensions.
void require_numbers(hid_t file, const TableGroup& group, const TableColumns& wanted,
                     const std::string& name) {
  const std::string folder = group.path == "/" ? "" : group.path;
  std::vector<std::string> names = wanted.required;
  names.insert(names.end(), wanted.optional.begin(), wanted.optional.end());
  for (const std::string& column : names)
    if (!has_columns(group.names(), {.required = {column}}) && h5::exists(file, folder + "/" + column))
      throw FormatError(name + ": " + folder + "/" + column +
                        " is not a column of numbers; a column has (N), (N, 1) or (1, N)");
}

NumberTable read_hdf5(const std::filesystem::path& path, const TableColumns& wanted) {
  const h5::Handle file = h5::open_file(path);
  const std::vector<TableGroup> groups = groups_of(file.get(), wanted);
  const TableGroup& group = group_of(groups, wanted, path.string());
  const auto fail = [&](const std::string& what) {
    std::string others;
    for (const TableGroup& other : groups)
      if (&other != &groups.front() && !other.columns.empty())
        others += (others.empty() ? "" : ", ") + other.path;
    throw FormatError(path.string() + ": " + what +
                      (others.empty() ? "" : "; nor has any of its groups: " + abbreviated(others)));
  };
  require_numbers(file.get(), group, wanted, path.string());
  std::map<std::string, std::vector<double>> columns;
  for (const MatchedColumn& column : matched_columns(group.names(), wanted, fail))
    columns[column.name] = values_of(group.columns[column.position], group, path.string());
  return {path.string(), std::move(columns)};
}

}  // namespace

NumberTable read_number_table(const std::filesystem::path& path, const TableColumns& columns) {
  require_regular_file(path);
  h5::initialise();
  const htri_t is_hdf5 = H5Fis_hdf5(path.c_str());
  if (is_hdf5 < 0) throw FormatError(path.string() + ": reading failed: " + h5::reading_failure());
  return is_hdf5 > 0 ? read_hdf5(path, columns) : read_text_table(path, columns);
}

TableLoader recording_table_loader(Provenance& provenance) {
  return [&provenance](const std::string& path, const std::string& role, const TableColumns& columns) {
    provenance.add_input(role, content_id(path), nlohmann::json::array());
    return read_number_table(path, columns);
  };
}

}  // namespace landfall
