// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <vector>

#include "store/hdf5/guard/raw_file.h"

namespace landfall::h5 {

/// A seal at the end of our own files, behind what HDF5 knows of, shows any damage to their metadata before
/// HDF5 reads them. It holds the places of all chunks, which have checksums of their own, and a hash of all
/// other bytes (docs/user/files/README.md). Programs that change a file through HDF5 remove the seal, because
/// HDF5 cuts a file at its own end when it closes it.

/// The addresses of all objects of an open file, for seal_file().
[[nodiscard]] std::vector<haddr_t> object_addresses(hid_t file);

/// Seals a complete file that HDF5 has closed. Throws IoError if the file cannot be read or written.
void seal_file(const std::filesystem::path& path, const std::vector<haddr_t>& objects);

enum class Seal { none, intact, broken };
/// `end` is where HDF5's contents end. A truncated seal is broken.
[[nodiscard]] Seal seal_of(const RawFile& file, std::uint64_t end);
/// Whether a file that MetadataGuard accepts ends with a seal.
[[nodiscard]] bool has_seal(const std::filesystem::path& path);

}  // namespace landfall::h5
