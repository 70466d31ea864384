// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <optional>
#include <string>

namespace landfall {

/// Whether each chunk that a selection of a dataset's space touches (H5S_ALL: any) holds as many bytes as
/// a chunk has, once its filters are undone. HDF5 1.10 does not ask: what is missing it reads from behind the
/// chunk's memory. Chunks that are not there pass, and so does a dataset that has none. Decodes all of them
/// once: for what decode_chunk() does not read itself. Values must be of one size (no variable lengths), and
/// undecodable_filter() none.
[[nodiscard]] bool chunks_are_whole(hid_t dataset, hid_t selection);

/// "4 (szip)", the first filter of a dataset that is none of these: shuffle, deflate after it, fletcher32
/// anywhere. Nothing where all are.
[[nodiscard]] std::optional<std::string> undecodable_filter(hid_t dataset);

}  // namespace landfall
