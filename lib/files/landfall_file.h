// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>

#include "files/provenance.h"
#include "hdf5/h5.h"
#include "output/output_path.h"

namespace landfall {

/// What every landfall file shares (docs/user/files/README.md): root attributes, /provenance, and a name
/// under which it appears only when it is complete.
class LandfallFileWriter {
 public:
  /// `kind` is terrain, scan, dem, evaluation or plan. Refuses before any work is done: UsageError where the
  /// output exists.
  LandfallFileWriter(const OutputOptions& options, const std::string& kind, const Provenance& provenance);

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] int compression() const { return compression_; }
  /// Marks the file complete, flushes and renames it. Throws IoError when writing fails.
  void commit();

 private:
  // The file is declared last: it closes before the temporary name is removed.
  OutputPath output_;
  int compression_;
  h5::Handle file_;
};

/// What a reader of any landfall file needs first.
class LandfallFileReader {
 public:
  /// Throws FormatError unless the file is a complete landfall file of one of `kinds` and of a format this
  /// version reads.
  LandfallFileReader(const std::filesystem::path& path, std::initializer_list<const char*> kinds);

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< for messages: the path as given
  [[nodiscard]] const std::string& file_id() const { return file_id_; }
  /// Everything upstream, and this file as the last step: each has the texts "tool" and "file_id"; its
  /// "inputs", where it has any, are a list, each of them with the texts "role" and "file_id".
  [[nodiscard]] const nlohmann::json& chain() const { return chain_; }
  /// The resolved configuration that made it, an object; null where the file does not say.
  [[nodiscard]] const nlohmann::json& config() const { return config_; }
  /// Throws FormatError "NAME: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void read_provenance();

  std::string name_;
  h5::Handle file_;
  std::string file_id_;
  nlohmann::json chain_ = nlohmann::json::array();
  nlohmann::json config_;
};

/// True where `path` names an HDF5 file that some landfall tool has begun: of any kind, and not necessarily
/// complete. Throws FormatError where the system does not let that be seen.
[[nodiscard]] bool is_landfall_file(const std::filesystem::path& path);

}  // namespace landfall
