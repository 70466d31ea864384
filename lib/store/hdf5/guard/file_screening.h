// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <filesystem>
#include <optional>
#include <string>

#include "store/hdf5/guard/metadata_check.h"

namespace landfall::h5 {

/// Follows the name of a file whose parts do not fit together. HDF5 files are so, too, while a program writes
/// them.
inline constexpr const char* kNotWhole =
    ": is an HDF5 file that is truncated or damaged, or still open elsewhere; make it again, or close it "
    "there";

/// Checks a file before libhdf5 reads it, which crashes on some damaged metadata. If the file has a seal
/// (file_seal.h), all its metadata are compared with their hash when the guard is made. MetadataCheck checks
/// the root group then, and each other object when it is opened. Make a guard before HDF5 opens the file.
class MetadataGuard {
 public:
  /// Throws FormatError, naming the file, if it is damaged. Accepts a file that is not HDF5.
  explicit MetadataGuard(const std::filesystem::path& path);

  /// Checks an object before HDF5 reads it. Throws FormatError, naming the file and `path`.
  void check(std::uint64_t address, const std::string& path);

 private:
  std::string name_;
  RawFile file_;
  std::optional<MetadataCheck> check_;  ///< none: it does not apply to this file
};

/// Checks an HDF5 file before a reader opens its objects: all data must be in the named file, readable by
/// this program alone, and of limited size.
///
/// Visits all objects but reads no values. Follows only hard links, so that no other file is opened. Throws
/// FormatError, which begins with `name` and names the path within the file, for
/// - a link that is not hard: external (naming its target), soft, user-defined;
/// - a virtual dataset, and one that keeps its values in other files (naming the first);
/// - a filter that is not part of HDF5 itself: plug-ins are programs, and are never loaded;
/// - chunks of more than 256 MiB;
/// - more than 256 MiB of values, if more than deflate could hold in the stored bytes;
/// - more than 2^20 objects, or a group that cannot be listed;
/// - attributes of dimension scales that libhdf5_hl would read past its memory (scale_check.h).
/// `guard`, which was made before the file was opened, checks each object before HDF5 reads it.
void screen_file(hid_t file, const std::string& name, MetadataGuard& guard);

}  // namespace landfall::h5
