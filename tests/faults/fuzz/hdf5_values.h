// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <string>
#include <vector>

#include "fuzz_target.h"
#include "store/hdf5/h5.h"

namespace landfall::fuzz {

/// The choices of an input: each takes a few of its bytes.
[[nodiscard]] double any_number(InputBytes& input);
/// `count` numbers, evenly apart.
[[nodiscard]] std::vector<double> ramp(std::size_t count, InputBytes& input);
/// A word of our files, broken JSON or UTF-8, deeply nested JSON, a long text, or the input's next bytes.
[[nodiscard]] std::string any_text(InputBytes& input);
[[nodiscard]] h5::Handle any_type(InputBytes& input);
/// 0 .. 2^40.
[[nodiscard]] hsize_t any_size(InputBytes& input);

struct Shape {
  h5::Handle space;
  std::vector<hsize_t> extent;
  std::size_t count = 0;  ///< values; 0 also for more than 2^20
};
/// Mostly one near `old_extent`.
[[nodiscard]] Shape any_shape(const std::vector<hsize_t>& old_extent, InputBytes& input);
/// A layout, filters and a fill value: the creation properties of a dataset.
[[nodiscard]] h5::Handle any_storage(const Shape& shape, InputBytes& input);

}  // namespace landfall::fuzz
