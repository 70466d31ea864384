// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "base/output/output_path.h"
#include "store/files/provenance.h"
#include "store/hdf5/h5.h"

namespace landfall {

namespace h5 {
class MemoryFile;
}

/// The kinds of files that the tools write.
inline constexpr std::initializer_list<const char*> kLandfallKinds = {
    "terrain", "scan", "dem", "evaluation", "plan", "hazards", "draws"};

/// The parts common to all landfall files (docs/user/files/README.md): root attributes, /provenance, and a
/// name under which the file appears only when it is complete.
class LandfallFileWriter {
 public:
  /// `kind` is one of kLandfallKinds. The file is in memory if the output has the name of an h5::MemoryFile.
  /// Throws UsageError before any work is done if the output exists.
  LandfallFileWriter(const OutputOptions& options, const std::string& kind, const Provenance& provenance);

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] int compression() const { return compression_; }
  [[nodiscard]] const std::string& kind() const { return kind_; }
  /// The file will not have the attribute Conventions, because CF cannot express something in it.
  void withdraw_cf_claim() { follows_cf_ = false; }
  /// Marks the file complete, flushes and renames it. Throws IoError when writing fails.
  void commit();

 private:
  // The file is declared last: it closes before the temporary name is removed.
  std::unique_ptr<OutputPath> output_;  ///< null in memory
  std::string kind_;
  int compression_;
  bool follows_cf_ = true;
  h5::Handle file_;
};

/// Writes a file in memory to the disk, as its tool would have. Throws as LandfallFileWriter does.
void save_file(h5::MemoryFile& file, const OutputOptions& options);

/// Opens and checks any landfall file.
class LandfallFileReader {
 public:
  /// Throws FormatError unless the file is a complete landfall file of one of `kinds` and of a format that
  /// this version reads.
  LandfallFileReader(const std::filesystem::path& path, std::initializer_list<const char*> kinds);

  [[nodiscard]] hid_t root() const { return file_.get(); }
  [[nodiscard]] const std::string& name() const { return name_; }  ///< for messages: the path as given
  [[nodiscard]] const std::string& file_id() const { return file_id_; }
  /// The first number of format_version.
  [[nodiscard]] int format_major() const { return format_major_; }
  /// All upstream steps, and this file as the last step. Each has the texts "tool" and "file_id"; its
  /// "inputs", if any, are a list of objects with the texts "role" and "file_id".
  [[nodiscard]] const nlohmann::json& chain() const { return chain_; }
  /// The resolved configuration that made the file, an object; null if the file does not contain one.
  [[nodiscard]] const nlohmann::json& config() const { return config_; }
  /// Throws FormatError "NAME: what".
  [[noreturn]] void fail(const std::string& what) const;

 private:
  void read_provenance();

  std::string name_;
  h5::Handle file_;
  std::string file_id_;
  int format_major_ = 1;
  nlohmann::json chain_ = nlohmann::json::array();
  nlohmann::json config_;
};

/// Checks a file as every reader does when it opens one, without reading values: that it is a regular HDF5
/// file with an intact seal or none, of a sound structure, self-contained and without foreign filters or
/// disproportionate sizes (h5::open_file()), of one of landfall's kinds, in a format that this version reads,
/// and complete. Takes the results of a study too, which no tool reads. Throws FormatError, naming the file.
void check_file(const std::filesystem::path& path);

/// Adds the seal of our files (h5::seal_file()) to a file without one that check_file() accepts, such as one
/// that Python wrote. Throws FormatError as check_file() does; IoError, naming the file, if writing fails.
void add_seal(const std::filesystem::path& path);

/// True if `path` is an HDF5 file that a landfall tool has begun: of any kind, and not necessarily complete.
/// Throws FormatError if the system refuses access.
[[nodiscard]] bool is_landfall_file(const std::filesystem::path& path);

}  // namespace landfall
