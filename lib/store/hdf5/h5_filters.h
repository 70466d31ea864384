// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <optional>
#include <string>
#include <vector>

namespace landfall::h5 {

struct Filter {
  H5Z_filter_t id = H5Z_FILTER_NONE;
  std::string name;  ///< as stored in the file; often empty
};

/// The filters of a dataset's creation properties, in the order in which they were applied.
[[nodiscard]] std::vector<Filter> filters_in(hid_t properties);

/// The level of a dataset's filter deflate; none where it has no such filter.
[[nodiscard]] std::optional<int> deflate_level(hid_t dataset);

/// "4 (szip)", or "4" if it has no name.
[[nodiscard]] std::string text_of(const Filter& filter);

}  // namespace landfall::h5
