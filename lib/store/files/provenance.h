// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace landfall {

/// One file that a step read.
struct InputRecord {
  std::string role;     ///< "terrain", "scan", "dem", "raster", "mesh", "trajectory"
  std::string file_id;  ///< of a landfall file; otherwise the hash of the bytes
  /// The statements that the file lacked or contradicted, and the assumptions instead
  /// (DemSource::assumed).
  std::vector<std::string> assumed = {};
  friend bool operator==(const InputRecord&, const InputRecord&) = default;
};

/// The origin of a file: everything needed to make it again, and nothing that differs between two equal runs
/// (no clock, host, path or thread count).
struct Provenance {
  std::string tool;
  nlohmann::json config = nullptr;  ///< the resolved configuration; paths in it are cut to the file's name
  /// Command-line options that change the content of the file (--keep-misses); null if none does.
  nlohmann::json options = nullptr;
  std::vector<InputRecord> inputs = {};
  /// The upstream steps, oldest first, each {"tool", "version", "file_id", "config", "inputs"}; a file that
  /// is reached in two ways is listed once.
  nlohmann::json chain = nlohmann::json::array();
  /// Host, clock and paths, only if the user requested them by --record-environment; null otherwise. Not part
  /// of the file_id.
  nlohmann::json environment = nullptr;

  /// A hash of program version, tool, resolved config, options and the inputs' ids: equal for equal runs.
  [[nodiscard]] std::string file_id() const;
  /// This step as an element of a downstream file's chain.
  [[nodiscard]] nlohmann::json as_step() const;
  /// Adds an input and everything upstream of it.
  void add_input(const std::string& role, const std::string& file_id, const nlohmann::json& upstream_chain,
                 std::vector<std::string> assumed = {});
};

/// The hash of a foreign file's bytes. Throws FormatError if it cannot be read.
[[nodiscard]] std::string content_id(const std::filesystem::path& path);

/// The tool that made the file with this chain; empty where no step says so.
[[nodiscard]] std::string maker_of(const nlohmann::json& chain);
/// Whether the file is made of data of another program: a step of its chain is landfall-import.
[[nodiscard]] bool is_imported(const nlohmann::json& chain);

/// "0.2.0", and "landfall scan-sim 0.2.0 (git 0123abc)".
[[nodiscard]] std::string program_version();
[[nodiscard]] std::string source_line(const std::string& tool);

}  // namespace landfall
