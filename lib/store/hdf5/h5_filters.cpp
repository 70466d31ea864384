// SPDX-License-Identifier: GPL-3.0-or-later
// No HDF5 plug-ins. The filter number in a file would select a library to load. Data compressed with Blosc
// and the like is refused with the filter's number and name; `h5repack` converts it to deflate.
#include "store/hdf5/h5_filters.h"

#include <array>
#include <cstddef>

#include "store/hdf5/h5.h"

namespace landfall::h5 {

std::vector<Filter> filters_in(hid_t properties) {
  std::vector<Filter> filters;
  for (int i = 0; i < H5Pget_nfilters(properties); ++i) {
    std::array<char, 64> name{};
    std::size_t value_count = 0;
    unsigned flags = 0;
    const H5Z_filter_t id = H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &value_count,
                                           nullptr, name.size() - 1, name.data(), nullptr);
    filters.push_back({id, name.data()});
  }
  return filters;
}

std::optional<int> deflate_level(hid_t dataset) {
  const Handle properties(H5Dget_create_plist(dataset), H5Pclose);
  unsigned level = 0;
  unsigned flags = 0;
  std::size_t value_count = 1;
  if (H5Pget_filter_by_id2(properties.get(), H5Z_FILTER_DEFLATE, &flags, &value_count, &level, 0, nullptr,
                           nullptr) < 0)
    return std::nullopt;
  return static_cast<int>(level);
}

std::string text_of(const Filter& filter) {
  return std::to_string(filter.id) + (filter.name.empty() ? "" : " (" + filter.name + ")");
}

}  // namespace landfall::h5
