// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "hdf5/guard/metadata_check.h"

namespace landfall::h5 {

/// Checks a file before libhdf5 reads it, which crashes on some damaged metadata. If the file has a seal
/// (file_seal.h), all its metadata are compared with their hash when the guard is made. MetadataCheck checks
/// the root group then, and each other object when it is asked for. Make a guard before HDF5 opens the file.
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

}  // namespace landfall::h5
