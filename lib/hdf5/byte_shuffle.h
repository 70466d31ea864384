// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>

namespace landfall {

/// The order of HDF5's shuffle filter: byte 0 of every element, then byte 1, and so on: one plane per byte of
/// an element. `elements` and `planes` have one size, a multiple of element_size (>= 1).
void shuffle_bytes(std::span<const std::byte> elements, std::size_t element_size,
                   std::span<std::byte> planes);

/// The inverse for some elements: `elements` receives as many as it holds, from number `first` on. They must
/// lie among those of `planes`.
void unshuffle_bytes(std::span<const std::byte> planes, std::size_t element_size, std::size_t first,
                     std::span<std::byte> elements);

}  // namespace landfall
