// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <optional>
#include <string>

namespace landfall {

/// Whether each chunk that a selection of a dataset's space touches (H5S_ALL: any) holds as many bytes as a
/// chunk has, once its filters are undone. HDF5 1.10 does not check this: it reads missing bytes from beyond
/// the chunk's memory. Chunks that are not stored pass, and so does a dataset without chunks. Decodes all of
/// them once: for data that decode_chunk() cannot read. Values must be of one size (no variable lengths), and
/// undecodable_filter() must return nothing.
[[nodiscard]] bool chunks_are_whole(hid_t dataset, hid_t selection);

/// Bytes of a chunk, and of all chunks side by side, which HDF5 must hold to read a dataset row by row and
/// decode each chunk once; 0 without chunks. HDF5 holds up to 1 MiB by itself.
struct ChunkBytes {
  double one = 0;
  double row = 0;
};
[[nodiscard]] ChunkBytes chunk_bytes_of(hid_t dataset);

/// "4 (szip)", the first filter of a dataset that is not supported. Supported are shuffle, deflate after it,
/// and fletcher32 anywhere. Returns nothing if all filters are supported.
[[nodiscard]] std::optional<std::string> undecodable_filter(hid_t dataset);

}  // namespace landfall
