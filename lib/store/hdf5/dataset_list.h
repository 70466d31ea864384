// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "store/hdf5/h5.h"

namespace landfall {

/// A dataset of numbers with 1 or 2 dimensions.
struct DatasetEntry {
  std::string name;
  std::string type;  ///< "float64", "uint8", ...
  std::vector<hsize_t> shape;
  std::string units;  ///< empty if not given
  std::string long_name;
  std::vector<int> flag_values;
  std::vector<int> flag_masks;
  std::vector<std::string> flag_meanings;
  hsize_t stored_bytes = 0;  ///< compressed size in the file
  h5::Handle dataset;

  [[nodiscard]] double value_count() const;
};

/// The datasets of a group in the order of their creation; texts, scalars and subgroups are left out.
[[nodiscard]] std::vector<DatasetEntry> list_datasets(hid_t group);

/// The names of the groups in a group, in the order of their creation.
[[nodiscard]] std::vector<std::string> list_groups(hid_t group);

}  // namespace landfall
